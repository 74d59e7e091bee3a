"""Facts from launch files: the nodes that a configuration starts, with names, remappings and parameters.

A configuration is one launch file evaluated as the main one, with all its includes. Texts are those after substitution.
A part only known at run time is the hole `{}` (`kg.holes`), and a `LaunchProblem` of the kind `unresolved` contains the
reason. The folder of a package in a text is `package://NAME`.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

# Imported at run time: the caches create facts from their annotations.
from kg.facts.places import Location  # noqa: TC001 - see above


class LaunchDialect(StrEnum):
    """The language of a launch file; `running` for a system observed at run time."""

    ROSLAUNCH = "roslaunch"
    ROS2_XML = "ros2-xml"
    ROS2_YAML = "ros2-yaml"
    ROS2_PYTHON = "ros2-python"
    RUNNING = "running"


class StartKind(StrEnum):
    """How a node is started."""

    NODE = "node"
    NODELET = "nodelet"
    NODELET_MANAGER = "nodelet-manager"
    COMPONENT = "component"
    CONTAINER = "container"
    LIFECYCLE_NODE = "lifecycle-node"
    TEST = "test"
    INNER = "inner"
    """Created by another node of the same process, not by a launch file."""
    RUNNING = "running"
    """Observed running; how it was started is unknown."""


class LaunchProblemKind(StrEnum):
    """Kind of error or unknown part in a configuration."""

    MISSING_FILE = "missing-file"
    """A file does not exist, in a package that does."""
    UNKNOWN_PACKAGE = "unknown-package"
    """A package is neither in the build nor installed, so its files are unknown."""
    UNDECLARED_ARGUMENT = "undeclared-argument"
    """An argument is passed to a file that does not declare it, or read without a declaration."""
    MISSING_ARGUMENT = "missing-argument"
    """An include does not pass an argument without default."""
    UNSET_VARIABLE = "unset-variable"
    """A variable of the environment that is not set has an empty default in some places and another one in others."""
    CYCLE = "cycle"
    """A file includes itself, directly or indirectly."""
    MALFORMED = "malformed"
    """Invalid syntax or structure."""
    OTHER_VERSION = "other-version"
    """The file is for ROS 1 and its package for ROS 2; it is not evaluated."""
    UNRESOLVED = "unresolved"
    """Something depends on values only known at run time."""
    UNKNOWN_PART = "unknown-part"
    """What is included or started is only known at run time, so nodes may be missing."""
    LIMIT = "limit"
    """A limit of size, depth or number was reached; the rest was not read."""


@dataclass(frozen=True, slots=True)
class LaunchArgument:
    """An argument declared by the main file of a configuration; `value` is its value after evaluation.

    It is required if `default` is None and it is not `fixed` (`<arg value=...>`, which callers cannot set).
    """

    name: str
    default: str | None
    value: str | None
    location: Location
    description: str | None = None
    fixed: bool = False
    choices: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class LaunchParameter:
    """A parameter that a configuration sets; `value` is YAML in one line, None if unknown.

    In ROS 1 `name` is absolute (`/move_base/controller_frequency`). In ROS 2 it is relative to the node
    (`controller_frequency`, `FollowPath.plugin`), `{}` for the parameters of an unknown file. `chain` contains the
    lines of the includes that led to it, outermost first.
    """

    name: str
    value: str | None
    location: Location
    chain: tuple[Location, ...] = ()
    type: str | None = None
    """A ROS parameter type (`bool`, `int`, `double`, `string`, `string_array`, ...)."""
    reason: str | None = None
    node: str | None = None
    """The enclosing key in a ROS 2 parameter file (`/ns/node`, `/**`), None if it is for its node alone.

    A process receives whole files, and the key selects the nodes that the parameter applies to.
    """


@dataclass(frozen=True, slots=True)
class Remap:
    """A remapping after substitution; if several match a name, the first one in the node's list applies."""

    source: str
    target: str
    location: Location
    chain: tuple[Location, ...] = ()


@dataclass(frozen=True, slots=True)
class StartedNode:
    """A node that a configuration starts.

    `name` is without namespace, None if the node uses its own name (ROS 2); `namespace` is absolute. `executable` is
    the program for `rosrun`/`ros2 run`, `plugin` the class of a nodelet or component, `host` the absolute name of its
    manager or container. `parameters` are those given to its process (ROS 2; in ROS 1 they are in the configuration),
    without those whose key names another node of the configuration. If two set the same parameter of a node, the later
    one applies. `condition` is the condition of the start as written, if its value is unknown; nodes certainly not
    started are left out.
    """

    name: str | None
    namespace: str
    kind: StartKind
    location: Location
    chain: tuple[Location, ...] = ()
    package: str | None = None
    executable: str | None = None
    plugin: str | None = None
    host: str | None = None
    remaps: tuple[Remap, ...] = ()
    parameters: tuple[LaunchParameter, ...] = ()
    arguments: tuple[str, ...] = ()
    condition: str | None = None
    settings: tuple[tuple[str, str], ...] = ()
    """Other attributes by name: `machine`, `respawn`, `required`, `output`, `launch-prefix`, `env NAME`, ..."""


@dataclass(frozen=True, slots=True)
class LaunchInclude:
    """An include: `written` after substitution; the file as `repository` and `path`, None if not found."""

    written: str
    location: Location
    chain: tuple[Location, ...] = ()
    repository: str | None = None
    path: str | None = None
    condition: str | None = None
    reason: str | None = None


@dataclass(frozen=True, slots=True)
class PluginValue:
    """Content of an element of a plugin: `element` is its path (`topicName`, `ros/namespace`, `camera@name`).

    Paths that begin with `../` belong to the sensor or model that contains the plugin.
    """

    element: str
    text: str
    location: Location


@dataclass(frozen=True, slots=True)
class LaunchPlugin:
    """A simulator plugin in a robot description, which is the value of the parameter `parameter` (an absolute name).

    `library` is the library as written; `location` is the line of its `<plugin>`, `chain` the lines that led to it:
    includes of launch files, the parameter, and includes of robot descriptions.
    """

    library: str
    parameter: str
    location: Location
    chain: tuple[Location, ...] = ()
    name: str | None = None
    values: tuple[PluginValue, ...] = ()
    condition: str | None = None
    """The condition for its existence, as written in the description, if its value is unknown."""


@dataclass(frozen=True, slots=True)
class LaunchProblem:
    """An error or unknown part in a configuration; `subject` is the name concerned (a file, an argument)."""

    kind: LaunchProblemKind
    message: str
    location: Location
    chain: tuple[Location, ...] = ()
    subject: str | None = None


@dataclass(frozen=True, slots=True)
class LaunchConfiguration:
    """A launch file and all its includes, evaluated; `given` contains arguments set by the caller.

    Locations without a repository are in `repository`. `files` are all launch and parameter files that were read, as
    pairs of repository and path.
    """

    repository: str
    package: str
    path: str
    ros: int
    dialect: LaunchDialect
    given: tuple[tuple[str, str], ...] = ()
    arguments: tuple[LaunchArgument, ...] = ()
    nodes: tuple[StartedNode, ...] = ()
    parameters: tuple[LaunchParameter, ...] = ()
    """Parameter server of ROS 1 in the order of setting: absolute names; the later of two values applies."""
    includes: tuple[LaunchInclude, ...] = ()
    problems: tuple[LaunchProblem, ...] = ()
    files: tuple[tuple[str, str], ...] = ()
    folder: str = "."
    """The folder of the package, relative to the source."""
    plugins: tuple[LaunchPlugin, ...] = ()
    """Simulator plugins in the robot descriptions among the final parameters."""

    @property
    def name(self) -> str:
        """Display name: the package, and the path in it."""
        return f"{self.package}/{self.path if self.folder == '.' else self.path.removeprefix(f'{self.folder}/')}"
