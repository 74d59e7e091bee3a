"""Facts that launch files give: what a configuration starts, with which names, remappings and parameters.

A configuration is one launch file evaluated as the one that is started, with everything that it includes. Texts are
those after substitution; a part that cannot be known without running anything is the hole `{}` (`kg.holes`), and a
`LaunchProblem` of the kind `unresolved` tells the reason. The folder of a package in a text is `package://NAME`.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

# Imported when the module is, for the caches make facts from their annotations.
from kg.facts.places import Location  # noqa: TC001 - see above


class LaunchDialect(StrEnum):
    """The language of a launch file; `running` is none: of a system that was seen running."""

    ROSLAUNCH = "roslaunch"
    ROS2_XML = "ros2-xml"
    ROS2_YAML = "ros2-yaml"
    ROS2_PYTHON = "ros2-python"
    RUNNING = "running"


class StartKind(StrEnum):
    """How something is started."""

    NODE = "node"
    NODELET = "nodelet"
    NODELET_MANAGER = "nodelet-manager"
    COMPONENT = "component"
    CONTAINER = "container"
    LIFECYCLE_NODE = "lifecycle-node"
    TEST = "test"
    INNER = "inner"
    """Made by a node of the same process, which no launch file says."""
    RUNNING = "running"
    """Seen running, however it was started."""


class LaunchProblemKind(StrEnum):
    """What is wrong, or not known, in a configuration."""

    MISSING_FILE = "missing-file"
    """A file is named that does not exist, in a package that does."""
    UNKNOWN_PACKAGE = "unknown-package"
    """A package is named that is neither in the build nor installed; nothing can be said about its files."""
    UNDECLARED_ARGUMENT = "undeclared-argument"
    """An argument is passed to a file that does not declare it, or read where none is declared."""
    MISSING_ARGUMENT = "missing-argument"
    """An argument without default is not given by an include."""
    CYCLE = "cycle"
    """A file includes itself, by way of others or not."""
    MALFORMED = "malformed"
    """What is written is not a valid launch file."""
    OTHER_VERSION = "other-version"
    """The file is written for ROS 1, and its package is of ROS 2; it is not evaluated."""
    UNRESOLVED = "unresolved"
    """Something depends on what is known only at run time."""
    LIMIT = "limit"
    """A limit of size, depth or number was reached; what lies behind was not read."""


@dataclass(frozen=True, slots=True)
class LaunchArgument:
    """An argument that the file of a configuration declares itself; `value` is what it has after evaluation.

    It is required where `default` is None and it is not `fixed` (`<arg value=...>`, which callers cannot set).
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
    """A parameter that a configuration sets; `value` is written as YAML in one line, None where it is not known.

    In ROS 1 `name` is absolute (`/move_base/controller_frequency`); in ROS 2 it is that of the node's parameter
    (`controller_frequency`, `FollowPath.plugin`), `{}` for those of a file that is not known. `chain` are the lines of
    the includes that led to it, outermost first.
    """

    name: str
    value: str | None
    location: Location
    chain: tuple[Location, ...] = ()
    type: str | None = None
    """A ROS parameter type (`bool`, `int`, `double`, `string`, `string_array`, ...)."""
    reason: str | None = None
    node: str | None = None
    """The key of a parameter file of ROS 2 that it stands below (`/ns/node`, `/**`), None where it is for the node that
    has it alone. A process is given whole files, and the key tells which of its nodes a parameter is for."""


@dataclass(frozen=True, slots=True)
class Remap:
    """A remapping as written after substitution; of several that fit a name the first in the node's list counts."""

    source: str
    target: str
    location: Location
    chain: tuple[Location, ...] = ()


@dataclass(frozen=True, slots=True)
class StartedNode:
    """A node that a configuration starts.

    `name` is without namespace, None where the node's own name is kept (ROS 2); `namespace` is absolute. `executable`
    is what `rosrun`/`ros2 run` start, `plugin` the class of a nodelet or component, `host` the absolute name of the
    manager or container that it is loaded into. `parameters` are those given to its process (ROS 2; in ROS 1 they stand
    in the configuration), those left out whose key names another node of the configuration; of two of one name for one
    node the later counts. `condition` says what has to hold, in the words of the
    file, where that cannot be known; what surely is not started is left out.
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
    """An include: `written` after substitution; the file as `repository` and `path`, None where it is not found."""

    written: str
    location: Location
    chain: tuple[Location, ...] = ()
    repository: str | None = None
    path: str | None = None
    condition: str | None = None
    reason: str | None = None


@dataclass(frozen=True, slots=True)
class PluginValue:
    """What stands in an element of a plugin: `element` is its path (`topicName`, `ros/namespace`, `camera@name`).

    Paths that begin with `../` are of the sensor or model that the plugin stands in.
    """

    element: str
    text: str
    location: Location


@dataclass(frozen=True, slots=True)
class LaunchPlugin:
    """A plugin of a simulator in the robot description that the parameter `parameter` holds (an absolute name).

    `library` is the file that is loaded, as written; `location` is the line of its `<plugin>`, `chain` the lines that
    led to it: those of includes of launch files, of the parameter, and of includes of robot descriptions.
    """

    library: str
    parameter: str
    location: Location
    chain: tuple[Location, ...] = ()
    name: str | None = None
    values: tuple[PluginValue, ...] = ()
    condition: str | None = None
    """What has to hold for it to be there, in the words of the description, where that cannot be known."""


@dataclass(frozen=True, slots=True)
class LaunchProblem:
    """Something wrong or not known in a configuration; `subject` is the name it is about (a file, an argument)."""

    kind: LaunchProblemKind
    message: str
    location: Location
    chain: tuple[Location, ...] = ()
    subject: str | None = None


@dataclass(frozen=True, slots=True)
class LaunchConfiguration:
    """One launch file and everything it includes, evaluated; `given` are arguments that the caller set.

    Locations without a repository stand in `repository`. `files` are all launch and parameter files that were read, as
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
    """The parameter server of ROS 1 in the order of setting: all names absolute, the later of two counts."""
    includes: tuple[LaunchInclude, ...] = ()
    problems: tuple[LaunchProblem, ...] = ()
    files: tuple[tuple[str, str], ...] = ()
    folder: str = "."
    """The folder of the package, relative to the source."""
    plugins: tuple[LaunchPlugin, ...] = ()
    """The plugins of simulators in the robot descriptions that parameters hold when everything is set."""

    @property
    def name(self) -> str:
        """The name that people know it by: its package, and its path in that."""
        return f"{self.package}/{self.path if self.folder == '.' else self.path.removeprefix(f'{self.folder}/')}"
