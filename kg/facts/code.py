"""Facts from code, build files and manifests: packages, node types, interfaces and parameters."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Final, NamedTuple

# Imported at run time: the caches and property tests create facts from their annotations.
from kg.facts.launch import LaunchConfiguration  # noqa: TC001 - see above
from kg.facts.places import Location  # noqa: TC001 - see above
from kg.facts.texts import Description, Snippet  # noqa: TC001 - see above

TREE_NODE: Final = "BT::TreeNode"
"""Base class of nodes of behavior trees (BehaviorTree.CPP)."""
CAMERA_ORIGIN: Final = "image_transport.camera"
"""Origin of the `camera_info` that `image_transport` adds to a camera; its name follows that of the remapped image."""


class Resolution(StrEnum):
    """How the name of an interface was resolved, from best to worst."""

    LITERAL = "literal"
    CONSTANT = "constant"
    PARAMETER_DEFAULT = "parameter-default"
    LAUNCH_ARGUMENT = "launch-argument"
    PARTIAL = "partial"
    UNRESOLVED = "unresolved"


class Role(StrEnum):
    """Role of a node at an interface; the value is the key in `kg nodes --json`."""

    PUBLISHES = "publishes"
    SUBSCRIBES = "subscribes"
    SERVICES = "services"
    CLIENTS = "clients"
    ACTION_SERVERS = "action_servers"
    ACTION_CLIENTS = "action_clients"

    @property
    def channel(self) -> str:
        """The kind of channel: `topic`, `service` or `action`."""
        return _ENDS[self][0]

    @property
    def outward(self) -> bool:
        """Whether the node initiates the communication: it publishes or calls."""
        return _ENDS[self][1]

    @property
    def gives(self) -> bool:
        """Whether the end makes sense without a peer: the node publishes, or offers a service or an action."""
        return self.outward is (self.channel == "topic")

    @property
    def opposite(self) -> Role:
        """The role at the other end of the channel."""
        return _ENDS[self][2]

    @property
    def verb(self) -> str:
        """What the node does with a channel, in words: `publishes`, `subscribes to`, `offers` or `calls`."""
        return _ENDS[self][3]

    @property
    def heading(self) -> str:
        """What the node does with several channels, in words: `publishes`, `offers services`."""
        return str(self) if self.channel == "topic" else f"{self.verb} {self.channel}s"

    @property
    def relation(self) -> str:
        """The relation of RNKG from the node to a channel, in words: `serves action`."""
        return _ENDS[self][4]


_ENDS: Final[dict[Role, tuple[str, bool, Role, str, str]]] = {
    Role.PUBLISHES: ("topic", True, Role.SUBSCRIBES, "publishes", "publishes"),
    Role.SUBSCRIBES: ("topic", False, Role.PUBLISHES, "subscribes to", "subscribes"),
    Role.SERVICES: ("service", False, Role.CLIENTS, "offers", "provides"),
    Role.CLIENTS: ("service", True, Role.SERVICES, "calls", "calls"),
    Role.ACTION_SERVERS: ("action", False, Role.ACTION_CLIENTS, "offers", "serves action"),
    Role.ACTION_CLIENTS: ("action", True, Role.ACTION_SERVERS, "calls", "calls action"),
}
"""The channel of a role, whether the role is outward, its opposite, its verb and its relation."""


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
    """Classification of files as in RNKG section 3.2.1: kinds of code, and text."""

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
    PROGRAM = "program"
    """A program that is not read: a script in another language, or a binary."""


@dataclass(frozen=True, slots=True)
class Qos:
    """Quality of service of one end of a ROS 2 interface; None for a default that is unknown."""

    reliability: str | None = None
    durability: str | None = None
    history: str | None = None
    depth: int | None = None
    deadline: float | None = None
    """Longest time between two messages, in seconds; None for infinite."""
    lifespan: float | None = None
    """How long a message stays valid, in seconds."""
    liveliness: str | None = None
    """`automatic` or `manual_by_topic`."""
    lease_duration: float | None = None
    """How long a publisher may be silent before it counts as dead, in seconds."""

    def __str__(self) -> str:
        """Return the known policies: `reliable, volatile, keep_last 10`."""
        kept = self.history if self.depth is None else f"{self.history or 'depth'} {self.depth}"
        lasting = {"deadline": self.deadline, "lifespan": self.lifespan, "lease": self.lease_duration}
        words = [self.reliability, self.durability, kept, self.liveliness]
        words += [f"{name} {value:g} s" for name, value in lasting.items() if value is not None]
        return ", ".join(word for word in words if word)


HOLDS: Final = "holds"
"""The sign of a `Switch` that is a condition of the code."""


class Switch(NamedTuple):
    """A parameter, or an argument of the command line, that decides whether a node creates an interface.

    Written `~/use_map` if it must be true, or a text that is not empty; `~/type == scan` or `~/cameras > 1` if it must
    have such a value, `~/topic is set` if it must be set. A condition of the code that no parameter decides has its
    place instead of a parameter: `src/node.cpp:12 holds`. A `!` in front negates the condition.
    """

    parameter: str
    sign: str
    value: str | None
    wanted: bool

    @classmethod
    def parse(cls, written: str) -> Switch:
        """Return the switch that is written so."""
        parameter, sign, value = (*written.removeprefix("!").split(" ", 2), None, None)[:3]
        return cls(parameter or "", sign or "", value, not written.startswith("!"))


@dataclass(frozen=True, slots=True)
class Interface:
    """One end of a topic, service or action that a node declares.

    `name` is the name passed to ROS: relative (`scan`), private (`~/scan`) or absolute (`/scan`), prefixed with the
    namespace of the node handle. An unknown part is a hole (`kg.holes`; resolution `partial`); None if all of it is
    unknown (`unresolved`). `resolved` is the same name for a node started alone, under its own name, in the root
    namespace and without remapping. `written` is the expression in the code. `type` is `package/Type`. `parameter` is
    the parameter whose value the name is (`name` then contains its default). There, `argv[1]` is the first argument of
    the command line, `argv[--topic|-t]` the value of an option, `port[topic]` a port of a behavior tree node. `~/imu{}`
    means one interface for each matching parameter that is set, `~/topics[].name` one for that member of each element,
    `~/topics[key]` one for each key of a dictionary. `origin` is the framework or table that an `implicit` fact comes
    from, or `CAMERA_ORIGIN`. `reason` explains why something is unresolved.
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
    """Number of command line arguments required for the node to create the interface."""
    switches: tuple[str, ...] = ()
    """What decides whether the node creates it, see `Switch`; of conditions of the code the innermost one."""
    via: tuple[Location, ...] = ()
    """The calls from `location`, the innermost one in the node's own package, down to the framework call.

    Empty if the framework is called at `location`.
    """
    silent: bool = False
    """Whether the code publishes nothing on a publisher; False if that is unknown."""
    upon: tuple[str, ...] = ()
    """The types of the subscriptions in whose callbacks alone it is published; none if that is unknown."""
    ignored: bool = False
    """Whether the callback of a subscription does nothing with its messages; False if that is unknown."""
    unset: tuple[str, ...] = ()
    """Parts of its message that the code leaves empty while it sets others."""
    filled: tuple[str, ...] = ()
    """Parts of its message that the file that creates it sets."""
    node: str | None = None
    """The name that the code gives to the node that has it, if the program has others, of which it is not the first."""
    again: tuple[Location, ...] = ()
    """Other calls that create the same."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter that a node reads, writes or declares; `name` follows the rules of `Interface.name`.

    `type` is a ROS parameter type (`bool`, `int`, `double`, `string`, `double_array`, ...); `default` is YAML. Both are
    None if unknown.
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
    """Description in the declaration (`generate_parameter_library`, dynamic_reconfigure, a descriptor)."""
    via: tuple[Location, ...] = ()
    """As `Interface.via`."""


@dataclass(frozen=True, slots=True)
class Bound:
    """A limit that stopped the interpretation of a node, so facts may be missing.

    `limit` is `steps`, `depth` (of calls) or `turns` (of one loop); `location` is the call that was running.
    """

    limit: str
    location: Location


@dataclass(frozen=True, slots=True)
class Import:
    """A module or header from outside its package that a node imports, at its first import.

    `name` is as in the code: `RPi.GPIO`, `serial/serial.h`.
    """

    name: str
    location: Location


@dataclass(frozen=True, slots=True)
class PluginDefault:
    """A plugin loaded by default, without parameters: its `class_name`, and its name, if any."""

    class_name: str
    name: str | None = None


@dataclass(frozen=True, slots=True)
class PluginSlot:
    """A slot of a node for plugins of a base class (`nav2_core::Controller`, None if unknown).

    `names` is the parameter with the names of the plugins, `parameter` the one with the class of a plugin. The latter
    contains `{id}` for the plugin's name (`{id}.plugin`), or `[]` for an element of a list (`~/plugins[].type`). A slot
    is `fixed` if the code specifies the class; `reason` explains why a class is unknown. `via` is as in
    `Interface.via`.
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
    """Declarations in code of an executable, script, nodelet, component, plugin or node class (a node in RNKG)."""

    name: str
    kind: NodeKind
    language: str
    ros: int
    location: Location
    executable: str | None = None
    plugin: str | None = None
    node_name: str | None = None
    """The node's own name (`ros::init`, `Node("...")`), before any remapping. It has holes where it is not known."""
    node_namespace: str | None = None
    """The absolute namespace that its code gives it (ROS 2), in place of `/`, unless it is started in another one.

    Relative names of its interfaces do not contain it. It has a hole where it is not known.
    """
    base_class: str | None = None
    """Base class of a plugin or nodelet (`nodelet::Nodelet`, `nav2_core::Controller`)."""
    aliases: tuple[str, ...] = ()
    """Other executables that start it, and its names in build files: its target, or a library that only contains it."""
    sources: tuple[str, ...] = ()
    interfaces: tuple[Interface, ...] = ()
    parameters: tuple[Parameter, ...] = ()
    bounds: tuple[Bound, ...] = ()
    slots: tuple[PluginSlot, ...] = ()
    imports: tuple[Import, ...] = ()
    """Imports of its sources from outside the package, by name, without the C++ standard library."""
    exported: Location | None = None
    """For plugins, nodelets and components: the registration of the class, in a plugin description, CMake or C++."""


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
    """A dependency of a package; `kind` is the element of package.xml (`depend`, `exec_depend`, ...)."""

    name: str
    kind: str
    line: int


@dataclass(frozen=True, slots=True)
class Package:
    """A ROS package as described by its package.xml and build files."""

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
    """The other version of ROS in the conditions of its manifest; the package is read for `ros`."""


@dataclass(frozen=True, slots=True)
class SourceFile:
    """A file of a package, classified as in RNKG section 3.2.1; `digest` is the BLAKE2b of its bytes."""

    path: str
    kind: FileKind
    bytes: int
    digest: str
    text: str | None = None
    """Its content, if nodes read it at run time: a behavior tree."""


@dataclass(frozen=True, slots=True)
class DataFile:
    """A file of a package that nodes read at run time; `path` is relative to the root of its source."""

    repository: str
    package: str
    path: str
    text: str


@dataclass(frozen=True, slots=True)
class Problem:
    """A problem in the sources; `code` is a key of `kg.errors.CATALOGUE`."""

    code: str
    message: str
    path: str
    line: int | None = None


@dataclass(frozen=True, slots=True)
class Repository:
    """A source: a git checkout or a plain folder.

    `name` is `host/owner/name` from the remote (`github.com/husky/husky`), or `local/NAME` for a folder without one.
    `commit` is None if the folder is not a git checkout; `dirty` is whether it has uncommitted changes.
    """

    name: str
    root: str
    commit: str | None = None
    remote: str | None = None
    branch: str | None = None
    dirty: bool = False


@dataclass(frozen=True, slots=True)
class PackageFacts:
    """Facts about one package: the result of extraction, which is a pure function of its inputs.

    `inputs` maps all files that were read to their digests, including those of other packages (base classes, message
    definitions). Nothing else can change the result.
    """

    repository: str
    package: Package
    nodes: tuple[NodeType, ...] = ()
    definitions: tuple[InterfaceDefinition, ...] = ()
    files: tuple[SourceFile, ...] = ()
    problems: tuple[Problem, ...] = ()
    inputs: tuple[tuple[str, str], ...] = ()
    launches: tuple[LaunchConfiguration, ...] = ()
    """The launch files of the package, each evaluated as the main one with its default arguments."""
    programs: tuple[str, ...] = ()
    """Programs of the package for `rosrun` or `ros2 run`, whether or not a node was found in them."""
    descriptions: tuple[Description, ...] = ()
    """Descriptions of the package and its nodes, in the order of their places."""
    snippets: tuple[Snippet, ...] = ()
    """Lines of code cited by the facts, by file."""
