"""The interfaces of an instance: what its node type and its plugins declare, with the names that they have in it.

Names of interfaces whose text comes from a parameter: the part that the parameter gives, and its value.

A fact has the name with the parameter's default in it (`~/front/scan`, of the parameter `~/topic` with the default
`scan`), or a hole with its label where it has none. Where the default is in the name tells which part is the
parameter's.

Source: design.ros2.org/articles/qos_configurability.html; overrides of QoS are parameters named
`qos_overrides.<topic>.<publisher|subscription>[_<id>].<policy>`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Final

from kg.facts import (
    CAMERA_ORIGIN,
    InstanceInterface,
    Interface,
    LaunchParameter,
    Location,
    NodeReference,
    NodeType,
    Qos,
    Resolution,
    Role,
)
from kg.holes import ANONYMOUS, PARENT, hole_of, is_known, is_partial, partition
from kg.launch.wiring.families import effective, members
from kg.launch.wiring.values import Settings, parsed, shown
from kg.names import join, normalise

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.launch.wiring.behavior_trees import TreeNode
    from kg.launch.wiring.inner_nodes import Spelling
    from kg.launch.wiring.place import Place
    from kg.launch.wiring.plugins import Framework, Loaded
    from kg.launch.wiring.remapping import Remapping

_PREFIX: Final = "qos_overrides."
_ENTITIES: Final = {"publisher": Role.PUBLISHES, "subscription": Role.SUBSCRIBES}
_WORDS: Final = ("reliability", "durability", "history", "liveliness")
_DURATIONS: Final = {"deadline": "deadline", "lifespan": "lifespan", "liveliness_lease_duration": "lease_duration"}
_NANOSECONDS: Final = 1_000_000_000


class Overrides:
    """The overrides among the parameters of an instance."""

    def __init__(self, own: Mapping[str, LaunchParameter]) -> None:
        self.names: list[str] = []
        """The parameters that are overrides."""
        self._of: dict[tuple[str, Role], dict[str, Any]] = {}
        for name, parameter in own.items():
            if name.startswith(_PREFIX):
                self.names.append(name)
                self._read(name.removeprefix(_PREFIX), parameter.value)

    def _read(self, rest: str, value: str | None) -> None:
        topic, _, policy = rest.rpartition(".")
        topic, _, entity = topic.rpartition(".")
        role = _ENTITIES.get(entity.partition("_")[0])
        setting = parsed(value)
        if role is None or not topic:
            return
        number = isinstance(setting, int) and not isinstance(setting, bool)
        if (policy in _WORDS and isinstance(setting, str)) or (policy == "depth" and number):
            change: dict[str, object] = {policy: setting}
        elif policy in _DURATIONS and number:
            change = {_DURATIONS[policy]: setting / _NANOSECONDS}
        else:
            return
        self._of.setdefault((topic, role), {}).update(change)

    def applied(self, declared: Qos | None, topic: str | None, role: Role) -> Qos | None:
        """Return the quality of service in force at one end of a topic with an absolute name."""
        change = self._of.get((topic or "", role)) if self._of else None
        return replace(declared or Qos(), **change) if change else declared


_PORT: Final = re.compile(r"port\[(\w+)\]")
"""What stands for a parameter where a name is a port of a node of behavior trees."""
_OF_NODES: Final = ("ros1.node", "ros2.node")
"""What every node has, and a plugin has not: it stands in a node."""

_MEMBER: Final = re.compile(r"\[(['\"])\w+\1\]|\.get\([^()]*\)")
_PARENT: Final = f"{{{PARENT}}}/"
_HANDLE_UNKNOWN: Final = "the namespace of the node handle is not known"


@dataclass(frozen=True, slots=True)
class Named:
    """A name before namespaces and remappings; None when nothing of it is known."""

    name: str | None
    resolution: Resolution
    parameter: LaunchParameter | None = None
    reason: str | None = None


def _defaults(node: NodeType, parameter: str | None) -> list[str]:
    """Return the texts that a parameter of a node type has by default."""
    texts = (shown(one.default) for one in node.parameters if one.name == parameter and one.default is not None)
    return [text for text in texts if text is not None]


def named(declared: Interface, node: NodeType, setting: LaunchParameter | None) -> Named:
    """Return the name that an interface of a node type has with `setting` for its parameter."""
    if setting is None:
        return Named(declared.name, declared.resolution, None, declared.reason)
    before, after, sure = _around(declared, _defaults(node, declared.parameter))
    rooted = declared.name is not None and declared.name.startswith("/") and node.language == "cpp"
    if rooted and before + after == "":
        sure = False  # an absolute default hides the namespace of the handle
    value = shown(setting.value)
    if value is None:
        unknown = setting.reason or f"the value of the parameter {setting.name} is not known before run time"
        return Named(_put(before, hole_of(declared.parameter or ""), after), Resolution.PARTIAL, setting, unknown)
    of_handle = before == "~/" and node.ros == 1 and node.language == "cpp"  # an empty name is that of the handle
    if not value.strip() and not (before + after).strip("/~") and not of_handle:
        empty = f"the parameter {setting.name} is empty"
        return Named(None, Resolution.UNRESOLVED, setting, empty)
    name = _put(before, value.strip(), after)
    if name.startswith("/") and _in_own_namespace(declared, node):
        name = name.lstrip("/")
    if is_partial(name):
        return Named(name, Resolution.PARTIAL, setting, setting.reason or declared.reason)
    if not sure and not name.startswith(("/", "~")):
        return Named(name, Resolution.PARTIAL, setting, _HANDLE_UNKNOWN)
    return Named(name, Resolution.LAUNCH_ARGUMENT, setting)


def _in_own_namespace(declared: Interface, node: NodeType) -> bool:
    """Return whether code puts the node's namespace in front of a value that by default is an absolute name."""
    name = declared.name
    defaults = _defaults(node, declared.parameter) if name is not None and not name.startswith("/") else ()
    return any(text.startswith("/") and normalise(text)[1:] == name for text in defaults)


def _around(declared: Interface, defaults: Iterable[str]) -> tuple[str, str, bool]:
    """Return the text before and after the parameter's part of a name, and whether it is certain."""
    name = declared.name
    if name is None:
        return "", "", not (declared.written or "").strip() or _plain(declared.written)
    if name.startswith(_PARENT):
        before, after, sure = _around(replace(declared, name=name.removeprefix(_PARENT)), defaults)
        return _PARENT + before, after, sure
    own = hole_of(declared.parameter or "")
    before, hole, after = partition(name, own)
    if hole and (hole == own or (declared.parameter or "") in (declared.reason or "")):
        return before, after, True
    texts = sorted({normalise(text) for text in defaults if text}, key=len, reverse=True)
    if name.strip("/~") and "" in defaults and not texts:  # a prefix (`ns + "/scan"`): nothing of it is in the name
        return "", name, True
    for text in texts:
        if name == text:
            return "", "", True
        if name.endswith(f"/{text}"):
            return name.removesuffix(text), "", True
        if name.startswith(text):
            return "", name.removeprefix(text), True
    for text in texts:
        if name.count(text) == 1:
            before, _, after = name.partition(text)
            return before, after, True
    if name == "~" and "" in defaults:  # a private handle adds nothing to an empty default
        return "~/", "", _plain(declared.written)
    if name.startswith("~/") and _plain(declared.written):
        return f"{name.rpartition('/')[0]}/", "", True
    return "", "", _plain(declared.written)


def _plain(written: str | None) -> bool:
    """Return whether an expression is no more than a variable or a member of one: nothing is joined to its value."""
    bare = _MEMBER.sub("", (written or "").strip())
    return all(char.isalnum() or char in "_.:->()[]" for char in bare)


def _put(before: str, value: str, after: str) -> str:
    """Return the name with a value in its part; an absolute or private value leaves what a handle puts in front."""
    if value.startswith(("/", "~")) and (not before or before.endswith("/")):
        return normalise(value + after)
    if not before.strip("/~") and not before.startswith(("/", "~")):
        return normalise(value + after)
    if before.endswith("/"):
        return join(before, normalise(value + after))
    return normalise(before + value + after)


@dataclass(frozen=True, slots=True)
class Ends:
    """Makes the interfaces of one instance; `place` is that of the node."""

    place: Place
    settings: Settings
    remapping: Remapping
    overrides: Overrides
    ros: int
    spelling: Spelling | None = None
    """How names change in a node that is made under another name than its type gives itself."""
    defaults: Mapping[str, str | None] = field(default_factory=dict)
    """What the node's own parameters are by default, which its plugins may ask for."""

    def of_node(self, owner: NodeReference, node: NodeType) -> Iterator[InstanceInterface]:
        """Yield the ends that the node type declares."""
        ends: dict[Location, list[InstanceInterface]] = {}
        later: list[Interface] = []
        for declared in effective(node.interfaces, self.settings):
            spelled = self.spelling.names(declared) if self.spelling is not None else None
            if spelled is not None:
                for one in spelled:
                    yield self._placed(declared, owner, Named(one, Resolution.CONSTANT), self.place)
                continue
            if declared.name is not None and (declared.implicit or declared.origin == CAMERA_ORIGIN):
                later.append(declared)
                continue
            for name in self._names(declared, node):
                end = self._placed(declared, owner, name, self.place, _handle(declared, node))
                ends.setdefault(declared.location, []).append(end)
                yield end
        for declared in later:
            base = next((end for end in ends.get(declared.location, ()) if _is_derived(declared, end)), None)
            if base is not None:
                yield self._derived(declared, base)
            else:
                name = self._named(declared, node, declared.parameter, self.place)
                yield self._placed(declared, owner, name, self.place, _handle(declared, node))

    def _names(
        self, declared: Interface, node: NodeType, done: frozenset[str] = frozenset({ANONYMOUS})
    ) -> Iterator[Named]:
        """Yield the names of an interface, several parts of which can be parameters; holes that are `done` stay."""
        done |= {hole_of(declared.parameter or "")}
        for value, whole in members(declared, node, self.settings, self.place):
            name = self._unless_set(declared.parameter, named(declared, node, value))
            name = replace(name, parameter=whole) if name.parameter is not None else name
            left = name.name if name.parameter is not None and name.name is not None else ""
            parameters = [one.name for one in node.parameters if one.name is not None] if "{" in left else ()
            sources = {hole_of(source): source for one in parameters for source in (one, f"{one}[key]")}
            other = next((source for hole, source in sources.items() if hole in left and hole not in done), None)
            if other is None:
                yield name
            else:
                yield from self._names(replace(declared, name=left, parameter=other), node, done)

    def _derived(self, declared: Interface, base: InstanceInterface) -> InstanceInterface:
        """Return an end whose name is made of that of another after its remapping, as `image_transport` does.

        Its releases for ROS 2 differ in this, so a remapping of the name before counts, too.
        """
        own = self.place.expand(declared.name or "", self.ros)
        moved, remap = self.remapping.apply(own, declared.role) if self.ros != 1 else (own, None)
        if remap is not None:
            return replace(base, declared=declared, resolved=moved, remap=remap, qos=declared.qos)
        above, name = base.declared.name or "", declared.name or ""
        resolved = base.resolved or ""
        if name.startswith(f"{above}/"):
            resolved += name.removeprefix(above)
        else:
            resolved = f"{resolved.rpartition('/')[0]}/{name.rpartition('/')[2]}"
        moved, remap = self.remapping.apply(resolved, declared.role)
        return replace(base, declared=declared, resolved=moved, remap=remap or base.remap, qos=declared.qos)

    def of_plugin(self, plugin: Loaded) -> Iterator[InstanceInterface]:
        """Yield the ends that a loaded plugin declares."""
        if plugin.typed is None:
            return
        owner, node = plugin.typed
        framework, place = plugin.framework, plugin.place(self.place)
        for declared in node.interfaces:
            if declared.implicit and (declared.origin or "").startswith(_OF_NODES):
                continue
            if declared.location.path.endswith(framework.foreign or ("\0",)):
                continue
            if self.spelling is not None and declared.name in self.spelling.row.outside:
                continue
            open_name = declared.name is None or hole_of(declared.parameter or "") in declared.name
            element = plugin.of_element(declared.parameter) if open_name else None
            if framework.each is not None and element is not None:
                yield from self._for_each(declared, element, plugin, place)
                continue
            spelled = plugin.handed(declared)
            own = self.place if spelled.name != declared.name else place
            parameter, at = declared.parameter, place
            if parameter is not None:
                parameter, at = plugin.read_as(parameter, self.place)
            name = self._named(spelled, node, parameter, at)
            if name.parameter is None and node.ros != 1 and not is_known(name.name):
                name = self._by_default(declared, parameter) or name
            yield self._placed(declared, owner, name, own)

    def of_tree_node(self, used: TreeNode) -> Iterator[InstanceInterface]:
        """Yield the ends of a node of a behavior tree; the element of the tree has the ports that name interfaces."""
        owner, node = used.typed
        for declared in node.interfaces:
            if declared.implicit and (declared.origin or "").startswith(_OF_NODES):
                continue
            port = _PORT.fullmatch(declared.parameter or "")
            given = used.ports.get(port[1]) if port is not None else None
            if port is not None:
                name = named(declared, node, given)
            else:
                name = self._named(declared, node, declared.parameter, self.place)
            yield self._placed(declared, owner, replace(name, parameter=name.parameter or used.element), self.place)

    def _by_default(self, declared: Interface, parameter: str | None) -> Named | None:
        """Return the name that a parameter of the node gives to an interface of a plugin where nothing sets it."""
        value = shown(self.defaults.get(parameter or ""))
        if not value:
            return None
        before, _, after = partition(declared.name or ANONYMOUS, hole_of(declared.parameter or ""))
        return Named(before + value + after, Resolution.PARAMETER_DEFAULT)

    def _for_each(self, declared: Interface, element: str, plugin: Loaded, place: Place) -> Iterator[InstanceInterface]:
        if plugin.typed is None:
            return
        (owner, node), framework = plugin.typed, plugin.framework
        for identifier in _ids_of(framework, self.settings, place):
            below = join("~", framework.below.replace("{id}", identifier))
            if framework.chosen is not None and declared.type is not None:
                setting = self.settings.get(f"{below}/{framework.chosen}", place)
                chosen = shown(setting.value) if setting is not None else framework.otherwise
                if chosen is not None and declared.type.rpartition("/")[2] != chosen:
                    continue
            name = self._named(declared, node, f"{below}/{element}", place)
            if name.parameter is None:
                before, _, after = partition(declared.name or ANONYMOUS, hole_of(declared.parameter or ""))
                name = Named(before + identifier + after, Resolution.PARAMETER_DEFAULT)
            elif name.resolution is Resolution.PARTIAL and is_known(name.name):
                name = Named(name.name, Resolution.LAUNCH_ARGUMENT, name.parameter)
            yield self._placed(declared, owner, name, place)

    def _named(self, declared: Interface, node: NodeType, parameter: str | None, place: Place) -> Named:
        if parameter is None or is_partial(parameter):
            return Named(declared.name, declared.resolution, None, declared.reason)
        return self._unless_set(parameter, named(declared, node, self.settings.get(parameter, place)))

    def _unless_set(self, parameter: str | None, name: Named) -> Named:
        """Return a name by default with the doubt about it, if there may be a setting that is not known."""
        is_default = name.resolution is Resolution.PARAMETER_DEFAULT and name.parameter is None
        if not is_default or parameter is None or not self.settings.has_unread(self.place):
            return name
        return replace(name, reason=f"unless an unknown parameter file sets {parameter}")

    def _placed(
        self, declared: Interface, owner: NodeReference, name: Named, place: Place, handle: str | None = None
    ) -> InstanceInterface:
        if name.name is None:
            reason = name.reason or "nothing of its name is known before run time"
            return InstanceInterface(
                declared, owner, None, Resolution.UNRESOLVED, None, name.parameter, declared.qos, reason
            )
        resolved, remap = place.expand(name.name, self.ros), None
        if not is_partial(resolved):
            above = place.resolve(handle) if handle is not None and name.parameter is None else None
            resolved, remap = self.remapping.apply(resolved, declared.role, above)
        partial = is_partial(resolved)
        if is_partial(name.name) and not partial:  # the name and namespace of the node were all that was open
            how = Resolution.CONSTANT if declared.parameter is None else Resolution.PARAMETER_DEFAULT
            how = how if name.parameter is None else Resolution.LAUNCH_ARGUMENT
            name = replace(name, resolution=how, reason=None)
        return InstanceInterface(
            declared=declared,
            owner=owner,
            resolved=resolved,
            resolution=Resolution.PARTIAL if partial else name.resolution,
            remap=remap,
            parameter=name.parameter,
            qos=self.overrides.applied(declared.qos, resolved, declared.role),
            reason=name.reason or ("a part of it is known only at run time" if partial else None),
        )


def _is_derived(declared: Interface, base: InstanceInterface) -> bool:
    """Return whether a library makes the name of an end of that of another at the same line of code."""
    above, name = base.declared.name, declared.name or ""
    if above is None or not is_known(base.resolved):
        return False
    if name.startswith(f"{above}/"):
        return declared.implicit
    info = f"{above.rpartition('/')[0]}/camera_info" if "/" in above else "camera_info"
    return name == info and declared.origin == CAMERA_ORIGIN and base.declared.origin is None


def _ids_of(framework: Framework, settings: Settings, place: Place) -> list[str]:
    """Return the ids that the list parameter of a plugin names (`observation_sources`)."""
    setting = settings.get(f"~/{framework.each}", place) if framework.each else None
    value = parsed(setting.value) if setting is not None else None
    if isinstance(value, str):
        return value.split()
    return [str(item) for item in value] if isinstance(value, list) else []


def _handle(declared: Interface, node: NodeType) -> str | None:
    """Return the namespace of the node handle that a literal was given to, as names are written (roscpp)."""
    name, literal = declared.name, (declared.written or "").strip()
    if node.ros != 1 or node.language != "cpp" or name is None or not literal.startswith('"'):
        return None
    handle = name.removesuffix(f"/{literal.strip(chr(34)).strip('/')}")
    return handle if handle not in {name, "", "~"} else None
