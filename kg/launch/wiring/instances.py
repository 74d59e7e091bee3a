"""One started node as an instance: its type, what it loads, and its interfaces, parameters and remappings resolved.

Command line tools that a configuration starts as nodes: their arguments name what they publish and subscribe to.

`ontology/tools.toml` defines the words; its head explains it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import zip_longest
from typing import TYPE_CHECKING, Final, TypeAlias

from kg.facts import (
    Access,
    InstanceInterface,
    InstanceParameter,
    InstanceRemap,
    Interface,
    LaunchParameter,
    MissingType,
    NodeInstance,
    NodeKind,
    NodeReference,
    NodeType,
    Parameter,
    Remap,
    Resolution,
    Role,
    StartedNode,
    StartKind,
)
from kg.holes import ANONYMOUS, fits, is_known, is_partial
from kg.launch.wiring.families import marked, switched_on
from kg.launch.wiring.inner_nodes import (
    Inner,
    Spelling,
    addressed,
    filled_defaults,
    inner_nodes,
    of_own_node,
    other_nodes,
    without_inner,
)
from kg.launch.wiring.interfaces import Ends, Overrides
from kg.launch.wiring.place import Place, place_of
from kg.launch.wiring.plugin_table import load_rows
from kg.launch.wiring.plugins import Loaded, below_id, loaded_plugins
from kg.launch.wiring.remapping import Remapping, Rule, rules_of
from kg.launch.wiring.similar_names import Alike, alike_when_short
from kg.launch.wiring.simulation import Simulated, own_ends
from kg.launch.wiring.simulation_table import filled
from kg.launch.wiring.types import NodeTypes, Typed, own_name
from kg.launch.wiring.values import Server, Settings, parsed, shown
from kg.resources import folder

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kg.launch.wiring.behavior_trees import TreeNode

_Owned: TypeAlias = "tuple[Parameter, NodeReference]"


class Reads:
    """The parameters that the code of one instance asks for, by absolute name (`/node/x`, also in ROS 2)."""

    def __init__(self, place: Place, ros: int, remapping: Remapping) -> None:
        self._place = place
        self._ros = ros
        self._remapping = remapping
        self._exact: dict[str, _Owned] = {}
        self._patterns: dict[str, _Owned] = {}
        self._by_handle: dict[str, _Owned] = {}
        """Relative names in C++, as if given to a private handle: which handle it was is not always known."""

    def add_node(self, owner: NodeReference, node: NodeType) -> None:
        """Add the parameters of a node type."""
        for parameter in _read_first(node):
            if parameter.name is not None:
                self._add(self._absolute(parameter.name, self._place), parameter, owner)
                if self._ros == 1 and node.language == "cpp" and not parameter.name.startswith(("/", "~")):
                    self._by_handle.setdefault(self._place.resolve(f"~/{parameter.name}"), (parameter, owner))

    def add_plugin(self, plugin: Loaded) -> None:
        """Add the parameters of a loaded plugin."""
        if plugin.typed is None:
            return
        owner, node = plugin.typed
        place = plugin.place(self._place)
        for parameter in _read_first(node):
            name = parameter.name
            if name is not None and self._ros != 1:
                for absolute in self._of_loaded(name, plugin):
                    self._add(absolute, parameter, owner)
            elif name is not None:
                spelled = plugin.spelled(name)
                absolute = self._absolute(name, place) if spelled is None else self._absolute(spelled, self._place)
                self._add(absolute, parameter, owner)
                outer, slash, _ = plugin.parameter.rpartition("/")
                if slash and not name.startswith("/"):  # a handle for what stands beside the class
                    self._add(self._place.resolve(f"~/{outer}/{name.removeprefix('~/')}"), parameter, owner)

    def _of_loaded(self, name: str, plugin: Loaded) -> Iterator[str]:
        """Yield the absolute names that a parameter of a plugin may have in ROS 2: of its own, or of the node."""
        full, own = self._place.full, name.removeprefix("~/").replace("/", ".")
        below = below_id(own)
        yield f"{full}/{plugin.id}.{own if below is None else below}"
        if below is None and not name.startswith("~/"):
            yield f"{full}/{own}"

    def _absolute(self, name: str, place: Place) -> str:
        if self._ros == 1:
            return self._remapping.parameter(place.resolve(name))
        return f"{self._place.full}/{name.removeprefix('~/').lstrip('/')}"

    def _add(self, name: str, parameter: Parameter, owner: NodeReference) -> None:
        (self._patterns if is_partial(name) else self._exact).setdefault(name, (parameter, owner))

    def add_of_framework(self, names: Iterable[str], node: NodeType, owner: NodeReference, origin: str) -> None:
        """Add parameters, named relative to the node, that a framework asks for in the name of the node."""
        for name in names:
            parameter = Parameter(name, None, None, Access.READ, node.location, implicit=True, origin=origin)
            self._add(f"{self._place.full}/{name}", parameter, owner)

    def resolved(self, set_for: Iterable[tuple[str, LaunchParameter]]) -> Iterator[InstanceParameter]:
        """Yield the parameters set for the instance, given by absolute name, with what they set."""
        pairs = list(set_for)
        names = {name for name, _ in pairs}
        unset: Alike | None = None
        for name, parameter in pairs:
            owned = self._find(name)
            if owned is not None:
                yield InstanceParameter(name, parameter, *owned)
                continue
            if unset is None:
                unset = Alike(exact for exact in self._exact if exact not in names)
            yield InstanceParameter(name, parameter, similar=tuple(unset.find(name)))

    def _find(self, name: str) -> _Owned | None:
        exact = self._exact.get(name) or self._by_handle.get(name)
        if exact is not None:
            return exact
        above = name
        separator = "/" if self._ros == 1 else "."
        while separator in above[1:]:
            above = above.rpartition(separator)[0]
            if above in self._exact and len(above) > len(self._place.full):
                return self._exact[above]
        return next((owned for pattern, owned in self._patterns.items() if fits(pattern, name, ".+")), None)


def _read_first(node: NodeType) -> list[Parameter]:
    return sorted(node.parameters, key=lambda parameter: parameter.access is Access.WRITE)


_HOSTS: Final = (StartKind.NODELET_MANAGER, StartKind.CONTAINER)
_HOST_PACKAGES: Final = ("nodelet", "rclcpp_components")
"""Whose programs load others and have no topics of their own."""
_PLUGIN_PARAMETER: Final = re.compile(r"(^|.*[./_])(plugin|plugins|type)")

TOOL: Final = "command line"
"""The origin of interfaces that a command line names."""
_EACH: Final = "{each}"
_UNKNOWN: Final = "a part of the command line is known only at run time"


@dataclass(frozen=True, slots=True)
class Tool:
    """A row of the table."""

    ros: int
    package: str
    executable: tuple[str, ...]
    ends: tuple[str, ...]
    source: str
    operands: tuple[str, ...] = ()
    first: str | None = None
    options: tuple[str, ...] = ()
    class_: str | None = None


def tool_ends(started: StartedNode, ends: Ends, repository: str) -> Iterator[InstanceInterface]:
    """Yield the ends that the command line of a tool names; `repository` is the source of the configuration."""
    rows = (row for row in _rows() if row.ros == ends.ros)
    tool = next((one for row in rows if (one := _read(row, started, ends.settings)) is not None), None)
    if tool is None:
        return
    row, values, rest = tool
    owner = NodeReference(started.location.repository or repository, row.package, started.plugin or row.executable[0])
    for text in row.ends:
        for each in rest if _EACH in text else ("",):
            role, *parts = text.split(" ", 2)
            kind, name = (filled(part, {**values, "each": each}) for part in parts)
            if not name or kind is None:
                continue
            resolved, remap = ends.place.resolve(name), None
            partial = is_partial(resolved)
            if not partial:
                above = parts[1].rpartition("/")[0] if "{" not in parts[1] else ""  # a handle of the tool's own code
                handle = ends.place.resolve(above) if above else None
                resolved, remap = ends.remapping.apply(resolved, Role(role), handle)
            resolution = Resolution.PARTIAL if partial else Resolution.LAUNCH_ARGUMENT
            reason = _UNKNOWN if partial else None
            declared = Interface(
                Role(role), name, _type(kind), resolution, started.location, origin=TOOL, reason=reason
            )
            yield InstanceInterface(declared, owner, resolved, resolution, remap, reason=reason)


def _read(row: Tool, started: StartedNode, settings: Settings) -> tuple[Tool, dict[str, str], list[str]] | None:
    """Return the operands of a tool by their names, and the words after them; None for another program."""
    is_program = started.package == row.package and started.executable in row.executable
    if not is_program and (started.plugin is None or started.plugin != row.class_):
        return None
    words = _operands(settings.words, row.options)
    if words and row.first is not None and words.pop(0) != row.first:
        return None
    values = {name: word for name, word in zip_longest(row.operands, words[: len(row.operands)]) if word is not None}
    if row.ros != 1:
        given = {name: settings.own.get(name) for name in row.operands}
        set_here = {name: shown(one.value) for name, one in given.items() if one is not None}
        values = {name: text for name, text in set_here.items() if text is not None} | values
    return row, values, words[len(row.operands) :]


def _operands(words: list[str], options: tuple[str, ...]) -> list[str]:
    """Return words without options and their arguments."""
    operands: list[str] = []
    skip = False
    for word in words:
        if not skip and not word.startswith("-"):
            operands.append(word)
        skip = not skip and word in options
    return operands


def _type(kind: str) -> str | None:
    """Return a type as `package/Name`; None for an unknown one."""
    parts = kind.split("/")
    complete = len(parts) > 1 and not is_partial(kind)
    return f"{parts[0]}/{parts[-1]}" if complete else None


@cache
def _rows() -> tuple[Tool, ...]:
    return load_rows(folder("ontology") / "tools.toml", "tool", Tool)


@dataclass(slots=True)
class Draft:
    """An instance under construction: the findings on one node before all nodes of the configuration are known."""

    started: StartedNode
    """With those parameters only that are for this node of its process."""
    place: Place
    ros: int
    typed: Typed | None
    missing: MissingType | None
    reason: str | None
    rules: tuple[Rule, ...]
    plugins: list[Loaded] = field(default_factory=list)
    set_here: list[tuple[str, LaunchParameter]] = field(default_factory=list)
    """Parameters set for it, by absolute name."""
    used: set[Remap] = field(default_factory=set)
    """Its remappings that changed a name, here, in a nodelet that it manages, or in a node that it makes."""
    makes: tuple[Inner, ...] = ()
    """The nodes that it makes itself."""
    others: tuple[str, ...] = ()
    """The other nodes of its program, which are in its process under the names that the code gives them."""
    creator: Inner | None = None
    """What says that another node makes it."""
    process: str | None = None
    """What has the command line that such a node gets, by absolute name."""
    written: StartedNode | None = None
    """The node as the configuration starts it; none does that with a node that another makes."""
    for_many: set[LaunchParameter] = field(default_factory=set)
    """Parameters that such a node is given with many others, so that it need not have them."""
    defaults: dict[str, str | None] = field(default_factory=dict)
    """What its parameters are by default, by names relative to the node, as YAML."""
    repository: str = ""
    """The source of the configuration."""
    simulated: list[Simulated] = field(default_factory=list)
    """Plugins of robot descriptions that run in it."""
    tree_nodes: list[TreeNode] = field(default_factory=list)
    """The nodes of the behavior trees that it runs."""
    similar: tuple[str, ...] = ()
    """Packages that the unknown one it is started from may mean."""


def draft_of(started: StartedNode, types: NodeTypes, repository: str, ros: int, creator: Inner | None = None) -> Draft:
    """Return the draft of a node by itself: its type, its place and its rules."""
    typed, missing, reason = types.of(started, repository)
    place = place_of(started, typed[1] if typed is not None else None)
    other = started.name if creator is None and started.kind is StartKind.INNER else None
    makes = inner_nodes(typed) if creator is None and other is None else ()
    others = other_nodes(started, typed[1]) if typed is not None and not makes else ()
    if typed is not None and makes:
        typed = typed[0], without_inner(typed[1], makes)
    elif typed is not None and (others or other):
        typed = typed[0], of_own_node(typed[1], other)
    written = started
    if ros != 1:
        given = addressed(written.parameters, place.full, alone=creator is None)
        started = replace(started, parameters=tuple({parameter.name: parameter for parameter in given}.values()))
    draft = Draft(started, place, ros, typed, missing, reason, rules_of(started.remaps, place, ros))
    draft.makes, draft.others, draft.creator, draft.repository = makes, others, creator, repository
    if missing is MissingType.UNKNOWN_PACKAGE and started.package:
        draft.similar = types.like(started.package)
    if creator is None:
        draft.written = written
    else:
        for_many = (one for one in written.parameters if "*" in (one.node or ""))
        draft.for_many.update(addressed(for_many, place.full, alone=False))
    if typed is not None:
        for parameter in typed[1].parameters:
            name = parameter.name
            if name is None or parameter.default is None or parameter.access is Access.WRITE or is_partial(name):
                continue
            if ros != 1 or name.startswith("~/"):  # ROS 1: code that asks without `~` asks for what is not the node's
                draft.defaults[name.removeprefix("~/")] = parameter.default
    if creator is not None:
        draft.defaults.update(filled_defaults(creator, place))
    if ros != 1:
        draft.set_here = [(f"{place.full}/{given.name.lstrip('~/')}", given) for given in started.parameters]
    return draft


def loads(draft: Draft, types: NodeTypes) -> None:
    """Add the plugins that the parameters of an instance name, those that it declares by default among them."""
    values: dict[str, str | None] = dict(draft.defaults)
    below = f"{draft.place.full}/"
    values.update({name.removeprefix(below): given.value for name, given in draft.set_here})
    slots = draft.typed[1].slots if draft.typed is not None else ()
    if values or slots:
        package = draft.started.package
        plugins = loaded_plugins(values, types, draft.repository, draft.ros, package, slots)
        draft.plugins += (_outside(plugin, draft.makes) for plugin in plugins)


def _outside(plugin: Loaded, makes: tuple[Inner, ...]) -> Loaded:
    """Return a plugin without the code of the inner nodes that it is handed."""
    if plugin.typed is None or not makes:
        return plugin
    owner, node = plugin.typed
    return replace(plugin, typed=(owner, without_inner(node, makes)))


def finished(draft: Draft, server: Server | None, host: Draft | None) -> NodeInstance:
    """Return the instance; `server` is that of ROS 1, `host` what it is loaded into, if the configuration has that."""
    above = host.rules if host is not None and draft.ros == 1 and draft.started.kind is StartKind.NODELET else ()
    remapping = Remapping((*draft.rules, *above), draft.ros)
    settings = Settings(server if draft.ros == 1 else None, draft.started, remapping)
    overrides = Overrides(settings.own)
    ends = Ends(draft.place, settings, remapping, overrides, draft.ros, _spelling(draft), draft.defaults)
    interfaces = _interfaces(draft, ends)
    reads = Reads(draft.place, draft.ros, remapping)
    if draft.typed is not None:
        owner, node = draft.typed
        reads.add_node(owner, node)
        reads.add_of_framework((one.parameter for one in draft.plugins if one.parameter), node, owner, "plugins")
        reads.add_of_framework(overrides.names, node, owner, "qos_overrides")
    for plugin in _added(draft.plugins):
        reads.add_plugin(plugin)
    parameters = tuple(one for one in reads.resolved(draft.set_here) if one.declared or one.set not in draft.for_many)
    draft.used |= remapping.used
    if host is not None:
        host.used |= remapping.used
    tool = any(end.declared.origin == TOOL for end in interfaces)
    loaded = [plugin.typed[0] for plugin in draft.plugins if plugin.typed is not None]
    loaded += [node.typed[0] for node in draft.tree_nodes]
    return NodeInstance(
        name=draft.place.full,
        namespace=draft.place.namespace,
        started=draft.written or draft.started,
        type=draft.typed[0] if draft.typed is not None else None,
        reason=None if tool else draft.reason,
        plugins=tuple(dict.fromkeys(loaded)),
        host=draft.started.host,
        interfaces=interfaces,
        parameters=parameters,
        remaps=tuple(one for one in _remaps(draft, interfaces) if one.used or draft.creator is None),
        complete=_complete(draft, interfaces, tool=tool),
        missing=None if tool else draft.missing,
        similar=draft.similar,
    )


def _spelling(draft: Draft) -> Spelling | None:
    """Return how names change in a node that another makes."""
    if draft.creator is None or draft.typed is None:
        return None
    row = draft.creator
    ids = (one.id for one in draft.plugins if one.parameter.startswith(one.id) and one.class_name not in row.unless)
    return Spelling(row, own_name(draft.typed[1]), draft.place.name, tuple(ids))


def _interfaces(draft: Draft, ends: Ends) -> tuple[InstanceInterface, ...]:
    interfaces: list[InstanceInterface] = []
    if draft.typed is not None:
        owner, node = draft.typed
        node, doubtful = switched_on(node, ends.settings, draft.place)
        interfaces += marked(ends.of_node(owner, node), doubtful)
    for plugin in _added(draft.plugins):
        if plugin.typed is not None:
            owner, node = plugin.typed
            node, doubtful = switched_on(node, ends.settings, draft.place, plugin)
            interfaces += marked(ends.of_plugin(replace(plugin, typed=(owner, node))), doubtful)
    of_trees: dict[object, InstanceInterface] = {}
    for tree_node in draft.tree_nodes:
        owner, node = tree_node.typed
        node, doubtful = switched_on(node, ends.settings, draft.place)
        for end in marked(ends.of_tree_node(replace(tree_node, typed=(owner, node))), doubtful):
            of_trees.setdefault((end.declared, end.resolved), end)
    interfaces += of_trees.values()
    if draft.typed is None:
        interfaces += own_ends(draft.started, draft.place, ends.remapping, draft.ros, draft.repository)
        interfaces += tool_ends(draft.started, ends, draft.repository)
    for simulated in draft.simulated:
        interfaces += simulated.ends(draft.place, ends.remapping)
    return tuple(dict.fromkeys(interfaces))


def _added(plugins: Iterable[Loaded]) -> Iterator[Loaded]:
    """Yield the plugins whose facts the node does not have by itself; those of a nodelet are its program's, too."""
    return (one for one in plugins if one.typed is None or one.typed[1].kind is not NodeKind.NODELET)


def _remaps(draft: Draft, interfaces: Sequence[InstanceInterface]) -> tuple[InstanceRemap, ...]:
    """Return the remappings; those that changed nothing with the names, not remapped either, that they may mean."""
    own: Alike | None = None
    names: list[str] = []
    remaps = []
    for rule in draft.rules:
        used = rule.remap in draft.used
        similar: tuple[str, ...] = ()
        if not used:
            if own is None:
                unmapped = (end for end in interfaces if end.remap is None and not end.declared.implicit)
                names = sorted({end.resolved for end in unmapped if end.resolved is not None})
                own = Alike(names)
            short = (name for name in names if alike_when_short(rule.source, name))
            similar = tuple(own.find(rule.source) or short)
        remaps.append(InstanceRemap(rule.source, rule.target, rule.remap, used, similar))
    return tuple(remaps)


def _complete(draft: Draft, interfaces: Iterable[InstanceInterface], *, tool: bool) -> bool:
    if draft.started.kind in _HOSTS and draft.started.package in _HOST_PACKAGES:
        return True
    if draft.typed is None and not tool and not draft.tree_nodes:
        return False
    if any(plugin.typed is None for plugin in draft.plugins) or _loads_unknown_code(draft):
        return False
    if (draft.typed is not None and draft.reason is not None) or all(end.declared.implicit for end in interfaces):
        return False  # a node that talks to nobody: more likely nothing of it was found
    if any(name.endswith(f"/{ANONYMOUS}") or _names_plugins(name, given) for name, given in draft.set_here):
        return False
    return all(is_known(end.resolved) and end.resolution is not Resolution.PARTIAL for end in interfaces)


def _loads_unknown_code(draft: Draft) -> bool:
    """Return whether the node loads code of which nothing is known, such as a module with a computed name.

    Code outside of the sources that gets the node is named. Only rules about remappings and parameters allow for it.
    """
    slots = draft.typed[1].slots if draft.typed is not None else ()
    return any(not (slot.fixed or slot.base_class or slot.parameter) and slot.reason for slot in slots)


def _names_plugins(name: str, given: LaunchParameter) -> bool:
    """Return whether a parameter decides what is loaded, with an unknown value."""
    if _PLUGIN_PARAMETER.fullmatch(name) is None:
        return False
    return given.value is None or is_partial(str(parsed(given.value)))
