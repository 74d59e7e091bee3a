"""The actions of ROS 2 launch as values: created by the readers of XML, YAML and Python, then executed.

Source: the packages `launch`, `launch_ros` and `launch_xml` of ROS 2, whose names are kept. A `Text` is a sequence of
parts that are joined when the action is executed, in the context of that moment, as launch's substitutions are.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kg.facts import Location
    from kg.launch.files.ros2.context import Context

_MOST_PARTS: Final = 2_000


@dataclass(frozen=True, slots=True)
class Substitution:
    """A part of a text that is known only when it is executed.

    `kind` is that of the XML form: `var`, `env`, `find-pkg-share`, `find-pkg-prefix`, `find-exec`, `dirname`,
    `filename`, `eval`, `command`, `anon`, `not`, `and`, `or`, `any`, `all`, `equals`, `not-equals`, `if`,
    `file-content`, `path-join`, `local`, `unknown` (`reason` is why). `arguments` are its operands in order; a
    missing default is left out. Two have no form in XML: `replaced-file` gives the name of a copy of a file (operands:
    the file, whether texts are replaced, and old and new texts in turn), `rewritten-file` that of a copy of `file`, a
    `ParameterFile`.
    """

    kind: str
    arguments: tuple[Text, ...] = ()
    reason: str | None = None
    file: object = None


Part: TypeAlias = str | Substitution
Text: TypeAlias = tuple[Part, ...]


@dataclass(frozen=True, slots=True)
class Condition:
    """`value` has to be true (`IfCondition`), or not with `negated` (`UnlessCondition`); None: it cannot be known."""

    value: Text | None
    negated: bool = False
    written: str = ""

    @property
    def words(self) -> str:
        """The condition, in the words of the file."""
        text = self.written or "a value known only at run time"
        return f"not {text}" if self.negated else text


def unknown_text(reason: str) -> Text:
    """Return the text that cannot be known."""
    return (Substitution("unknown", reason=reason),)


def join(parts: Sequence[Part]) -> Text:
    """Return parts with neighbouring plain texts joined."""
    merged: list[Part] = []
    for part in parts[:_MOST_PARTS]:
        if isinstance(part, str) and merged and isinstance(merged[-1], str):
            merged[-1] += part
        elif part != "":
            merged.append(part)
    if len(parts) > _MOST_PARTS:
        merged.append(Substitution("unknown", reason="the text has too many parts"))
    return tuple(merged)


@dataclass(frozen=True, slots=True)
class ParameterValue:
    """Parameters given by name; a value is a text (YAML types apply unless `as_text`) or a value of Python known.

    The items of a list are values of Python, or texts (tuples) for those that are substituted. None: it cannot be
    known. `type` is the ROS parameter type that the file asks for (`int`, `double`, `string_array`).
    """

    name: Text
    value: Text | bool | float | list[object] | None
    location: Location
    as_text: bool = False
    type: str | None = None


@dataclass(frozen=True, slots=True)
class ParameterFile:
    """A file of parameters; with `substitutions` texts like `$(var x)` in it are substituted.

    `rewrites` are nav2's `RewrittenYaml`: pairs of a key and its new value, put wherever the file has a parameter of
    that name or dotted path, for any node; with `root` all nodes of the file are below that namespace; `keys` are
    pairs of a key of the file and what it is called instead, `values` pairs of a value and what is in its place.
    """

    path: Text
    location: Location
    substitutions: bool = False
    rewrites: tuple[tuple[Text, Text], ...] = ()
    root: Text | None = None
    keys: tuple[tuple[Text, Text], ...] = ()
    values: tuple[tuple[Text, Text], ...] = ()

    @property
    def read(self) -> Text:
        """The path of the file, or of the copy that is made of it."""
        changed = self.rewrites or self.root or self.keys or self.values
        return (Substitution("rewritten-file", file=self),) if changed else self.path


ParameterSource: TypeAlias = ParameterValue | ParameterFile


@dataclass(frozen=True, slots=True, kw_only=True)
class Action:
    """Fields of all actions."""

    location: Location
    condition: Condition | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DeclareArgument(Action):
    """`DeclareLaunchArgument`."""

    name: str
    default: Text | None = None
    description: str | None = None
    choices: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting(Action):
    """Sets something for the actions of the scope that come after; without a value it is unset.

    `what` and its `operands` are `configuration` (name and value: `SetLaunchConfiguration`, `<let>`), `variable` (name
    and value: `SetEnvironmentVariable`), `namespace` (`PushRosNamespace`) or `remap` (source and target: `SetRemap`).
    """

    what: str
    operands: tuple[Text, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ResetConfigurations(Action):
    """`ResetLaunchConfigurations`: all are forgotten but `configurations`, namespace and remappings too."""

    configurations: tuple[tuple[Text, Text], ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class SetParameters(Action):
    """`SetParameter`, `SetUseSimTime`, `SetParametersFromFile`: for all nodes of the scope that come after."""

    source: ParameterSource


@dataclass(frozen=True, slots=True, kw_only=True)
class Group(Action):
    """`GroupAction`; `scoped` restores configurations, namespace, remappings and parameters behind it.

    Without `forwarding` nothing of the surroundings is seen inside but `configurations`. Timers and handlers of events
    become groups too, that are not scoped and have a condition that cannot be known where that is so.
    """

    actions: Sequence[Action]
    scoped: bool = True
    forwarding: bool = True
    configurations: tuple[tuple[Text, Text], ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Include(Action):
    """`IncludeLaunchDescription`; `path` None: unknown, with the `reason`."""

    path: Text | None
    arguments: tuple[tuple[Text, Text], ...] = ()
    reason: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Executable(Action):
    """`ExecuteProcess`: matters only where the command starts a node (`ros2 run P E`, `--ros-args`)."""

    command: tuple[Text, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeAction(Action):
    """`Node`, `LifecycleNode`, `ComposableNodeContainer` (then `components` are loaded into it), `ComposableNode`.

    For a `ComposableNode` `plugin` is its class and `executable` None.
    """

    kind: str = "node"
    """`node`, `lifecycle-node`, `container` or `component`."""
    package: Text | None = None
    executable: Text | None = None
    plugin: Text | None = None
    name: Text | None = None
    namespace: Text | None = None
    remaps: tuple[tuple[Text, Text, Location], ...] = ()
    parameters: tuple[ParameterSource, ...] = ()
    arguments: tuple[Text, ...] = ()
    ros_arguments: tuple[Text, ...] = ()
    settings: tuple[tuple[str, Text], ...] = ()
    components: Sequence[NodeAction] = ()
    choice: Condition | None = None
    """For a component: what decides whether it is in the list, in addition to its own condition."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadComponents(Action):
    """`LoadComposableNodes` into the container `target`: its name, as seen from the root namespace.

    `container` is the action that starts it, where the file says that instead of a name.
    """

    target: Text | None
    components: Sequence[NodeAction] = ()
    container: NodeAction | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Opaque(Action):
    """`OpaqueFunction`: `run` gives the actions that its body returns, read in the context of the moment."""

    run: Callable[[Context], Sequence[Action]] = field(repr=False, compare=False)
