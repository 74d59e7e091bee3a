"""Facts that code, build files and manifests give: RNKG's packages, node types, interfaces and parameters."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Final

# Imported when the module is, for the caches and property tests make facts from their annotations.
from kg.facts.launch import LaunchConfiguration  # noqa: TC001 - see above
from kg.facts.places import Location  # noqa: TC001 - see above
from kg.facts.texts import Description, Snippet  # noqa: TC001 - see above

TREE_NODE: Final = "BT::TreeNode"
"""The class as which nodes of behavior trees are loaded (BehaviorTree.CPP)."""


class Resolution(StrEnum):
    """How the name of an interface became known, from best to worst."""

    LITERAL = "literal"
    CONSTANT = "constant"
    PARAMETER_DEFAULT = "parameter-default"
    LAUNCH_ARGUMENT = "launch-argument"
    PARTIAL = "partial"
    UNRESOLVED = "unresolved"


class Role(StrEnum):
    """What a node does at an interface; the value is the key in `kg nodes --json`."""

    PUBLISHES = "publishes"
    SUBSCRIBES = "subscribes"
    SERVICES = "services"
    CLIENTS = "clients"
    ACTION_SERVERS = "action_servers"
    ACTION_CLIENTS = "action_clients"

    @property
    def channel(self) -> str:
        """What it is an end of: a `topic`, `service` or `action`."""
        return _ENDS[self][0]

    @property
    def outward(self) -> bool:
        """Whether the node is the one that begins: it publishes or calls."""
        return _ENDS[self][1]

    @property
    def opposite(self) -> Role:
        """What a node at the other side of the channel does."""
        return _ENDS[self][2]


_ENDS: Final[dict[Role, tuple[str, bool, Role]]] = {
    Role.PUBLISHES: ("topic", True, Role.SUBSCRIBES),
    Role.SUBSCRIBES: ("topic", False, Role.PUBLISHES),
    Role.SERVICES: ("service", False, Role.CLIENTS),
    Role.CLIENTS: ("service", True, Role.SERVICES),
    Role.ACTION_SERVERS: ("action", False, Role.ACTION_CLIENTS),
    Role.ACTION_CLIENTS: ("action", True, Role.ACTION_SERVERS),
}
"""The channel of a role, whether it is outward, and its opposite."""


class NodeKind(StrEnum):
    """How a node is started."""

    EXECUTABLE = "executable"
    SCRIPT = "script"
    NODELET = "nodelet"
    COMPONENT = "component"
    PLUGIN = "plugin"
    CLASS = "class"


class Access(StrEnum):
    """What code does with a parameter."""

    READ = "read"
    WRITE = "write"
    DECLARE = "declare"


class FileKind(StrEnum):
    """The sorting of files of RNKG section 3.2.1: code by what it is, and text."""

    CPP = "cpp"
    PYTHON = "python"
    MESSAGE = "msg"
    SERVICE = "srv"
    ACTION = "action"
    LAUNCH = "launch"
    MANIFEST = "manifest"
    BUILD = "build"
    PLUGIN = "plugin"
    CONFIG = "config"
    TEXT = "text"


@dataclass(frozen=True, slots=True)
class Qos:
    """Quality of service of one end of a ROS 2 interface; None where the code leaves it to a default not known."""

    reliability: str | None = None
    durability: str | None = None
    history: str | None = None
    depth: int | None = None
    deadline: float | None = None
    """Longest time between two messages, in seconds; infinite where None."""
    lifespan: float | None = None
    """How long a message stays valid, in seconds."""
    liveliness: str | None = None
    """`automatic` or `manual_by_topic`."""
    lease_duration: float | None = None
    """How long a publisher may be silent before it is taken for dead, in seconds."""


@dataclass(frozen=True, slots=True)
class Interface:
    """One end of a topic, service or action that a node declares.

    `name` is the name as the node gives it to ROS: relative (`scan`), private (`~/scan`) or absolute
    (`/scan`), with the namespace of its node handle in front; a part that is not known is a hole (`kg.holes`)
    (resolution `partial`); None when nothing of it is known (`unresolved`). `resolved` is the same name
    for a node started alone, under its own name, in the root namespace and without remapping.
    `written` is the expression in the code. `type` is `package/Type`. `parameter` names the parameter
    whose value the name is (its default is then in `name`); `argv[1]` is the first argument of the command line,
    `argv[--topic|-t]` what an option gives, `port[topic]` a port of a behavior tree node; `~/imu{}` stands for as many
    parameters as are set whose names fit it, one interface for each, `~/topics[].name` for members of the elements of
    one, `~/topics[key]` for a dictionary's keys.
    `origin` says through which framework or table the fact came when it is `implicit`. `reason` tells why something
    stayed unresolved.
    """

    role: Role
    name: str | None
    type: str | None
    resolution: Resolution
    location: Location
    resolved: str | None = None
    written: str | None = None
    parameter: str | None = None
    implicit: bool = False
    origin: str | None = None
    qos: Qos | None = None
    reason: str | None = None
    arguments: int = 0
    """How many arguments the command line has to have for the node to make it."""
    switches: tuple[str, ...] = ()
    """Boolean parameters that have to be true for the node to make it; those that must not be have a `!` in front."""
    via: tuple[Location, ...] = ()
    """The calls from `location`, the innermost one in the node's own package, to the framework call, which is last.

    Empty if the framework is called at `location`.
    """


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter that a node reads, writes or declares; `name` follows the rules of `Interface.name`.

    `type` is a ROS parameter type (`bool`, `int`, `double`, `string`, `double_array`, ...); `default` is
    written as YAML. None where the code does not tell.
    """

    name: str | None
    type: str | None
    default: str | None
    access: Access
    location: Location
    resolution: Resolution = Resolution.LITERAL
    implicit: bool = False
    origin: str | None = None
    reason: str | None = None
    description: str | None = None
    """What the declaration says of it in words (`generate_parameter_library`, dynamic_reconfigure, a descriptor)."""
    via: tuple[Location, ...] = ()
    """As for `Interface.via`."""


@dataclass(frozen=True, slots=True)
class Bound:
    """A limit at which the interpretation of a node stopped short, so that facts may be missing.

    `limit` is `steps`, `depth` (of calls) or `turns` (of one loop); `location` is the call that was running.
    """

    limit: str
    location: Location


@dataclass(frozen=True, slots=True)
class Import:
    """A module or header from outside of its package that a node imports, at the first place that does.

    `name` is written as in the code: `RPi.GPIO`, `serial/serial.h`.
    """

    name: str
    location: Location


@dataclass(frozen=True, slots=True)
class PluginDefault:
    """A plugin that a node loads if its parameters are not set: its `class_name`, and the name that it gets, if any."""

    class_name: str
    name: str | None = None


@dataclass(frozen=True, slots=True)
class PluginSlot:
    """A place of a node for plugins of a base class (`nav2_core::Controller`, None if it is not known).

    `names` is the parameter with the names of the plugins, `parameter` the one with the class of a plugin. The latter
    has `{id}` for the plugin's name (`{id}.plugin`), or `[]` for an element of a list (`~/plugins[].type`). A slot is
    `fixed` if the code gives the class; `reason` tells why a class is not known. `via` is as for `Interface.via`.
    """

    base_class: str | None
    location: Location
    names: str | None = None
    parameter: str | None = None
    defaults: tuple[PluginDefault, ...] = ()
    fixed: bool = False
    reason: str | None = None
    via: tuple[Location, ...] = ()


@dataclass(frozen=True, slots=True)
class NodeType:
    """What an executable, script, nodelet, component, plugin or node class declares in code (RNKG's node)."""

    name: str
    kind: NodeKind
    language: str
    ros: int
    location: Location
    executable: str | None = None
    plugin: str | None = None
    node_name: str | None = None
    """The name it gives itself (`ros::init`, `Node("...")`), before any remapping."""
    base_class: str | None = None
    """For plugins and nodelets the class they are loaded as (`nodelet::Nodelet`, `nav2_core::Controller`)."""
    aliases: tuple[str, ...] = ()
    """Other executables that start it, and its names in build files: its target, a library that holds nothing else."""
    sources: tuple[str, ...] = ()
    interfaces: tuple[Interface, ...] = ()
    parameters: tuple[Parameter, ...] = ()
    bounds: tuple[Bound, ...] = ()
    slots: tuple[PluginSlot, ...] = ()
    imports: tuple[Import, ...] = ()
    """What its sources take from outside of the package, by name; not the C++ standard library."""
    exported: Location | None = None
    """For plugins, nodelets and components: what registers the class, in a plugin description, CMake or C++."""


@dataclass(frozen=True, slots=True)
class Field:
    """A field or constant of an interface definition.

    `section` is message, request, response, goal, result or feedback.
    """

    section: str
    name: str
    type: str
    line: int
    default: str | None = None
    constant: str | None = None
    comment: str | None = None


@dataclass(frozen=True, slots=True)
class InterfaceDefinition:
    """A message, service or action type with its fields; `kind` is msg, srv or action."""

    kind: str
    package: str
    name: str
    fields: tuple[Field, ...]
    location: Location


@dataclass(frozen=True, slots=True)
class Person:
    """A maintainer or author of a package."""

    name: str
    email: str | None = None
    role: str = "maintainer"


@dataclass(frozen=True, slots=True)
class Dependency:
    """What a package depends on; `kind` is the element of package.xml (`depend`, `exec_depend`, ...)."""

    name: str
    kind: str
    line: int


@dataclass(frozen=True, slots=True)
class Package:
    """A ROS package as its package.xml and build files describe it."""

    name: str
    path: str
    """Folder of the package, relative to the root of the source; `.` for the root itself."""
    ros: int
    location: Location
    version: str | None = None
    description: str | None = None
    format: int | None = None
    build_type: str | None = None
    licenses: tuple[str, ...] = ()
    people: tuple[Person, ...] = ()
    urls: tuple[tuple[str, str], ...] = ()
    """Pairs of kind (`website`, `repository`, `bugtracker`) and address."""
    dependencies: tuple[Dependency, ...] = ()
    deprecated: str | None = None
    also: int | None = None
    """The other version of ROS that its manifest has conditions for; it is read for `ros`."""


@dataclass(frozen=True, slots=True)
class SourceFile:
    """A file that belongs to a package, sorted as RNKG section 3.2.1 sorts them; `digest` is a BLAKE2b of its bytes."""

    path: str
    kind: FileKind
    bytes: int
    digest: str
    text: str | None = None
    """Its content, if nodes read it when they run: a behavior tree."""


@dataclass(frozen=True, slots=True)
class DataFile:
    """A file of a package that nodes read when they run; `path` is relative to the root of its source."""

    repository: str
    package: str
    path: str
    text: str


@dataclass(frozen=True, slots=True)
class Problem:
    """Something in the sources that could not be read as it should; `code` is a key of `kg.errors.CATALOGUE`."""

    code: str
    message: str
    path: str
    line: int | None = None


@dataclass(frozen=True, slots=True)
class Repository:
    """A source: a git checkout or a plain folder.

    `name` is `host/owner/name` from the remote (`github.com/husky/husky`), or `local/NAME` for a folder
    without one. `commit` is None where the folder is not a git checkout; `dirty` tells of changes on top of it.
    """

    name: str
    root: str
    commit: str | None = None
    remote: str | None = None
    branch: str | None = None
    dirty: bool = False


@dataclass(frozen=True, slots=True)
class PackageFacts:
    """All that was read of one package: the result of extraction, which is a pure function of the package.

    `inputs` maps every file that was read to its digest, those of other packages too (base classes,
    message definitions); nothing else can change the result.
    """

    repository: str
    package: Package
    nodes: tuple[NodeType, ...] = ()
    definitions: tuple[InterfaceDefinition, ...] = ()
    files: tuple[SourceFile, ...] = ()
    problems: tuple[Problem, ...] = ()
    inputs: tuple[tuple[str, str], ...] = ()
    launches: tuple[LaunchConfiguration, ...] = ()
    """Each launch file of the package, evaluated as if it were the one that is started, with its default arguments."""
    programs: tuple[str, ...] = ()
    """What `rosrun` or `ros2 run` can start of the package, in which a node was found or not."""
    descriptions: tuple[Description, ...] = ()
    """What people wrote about the package and its nodes, in the order of their places."""
    snippets: tuple[Snippet, ...] = ()
    """The lines of code that the facts rest on, by file."""
