"""Interfaces of simulated robots: the plugins in their descriptions run in the simulator, under own names.

In ROS 1 they share the simulator's node, in a namespace of a node handle, so that its remappings count; in ROS 2 each
is a node in its process. They belong to the instance that runs the simulator, else to the one that hands it the
description. `ontology/simulation.toml` lists what they make.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Final

from kg.facts import (
    InstanceInterface,
    Interface,
    LaunchConfiguration,
    LaunchPlugin,
    Location,
    NodeReference,
    Remap,
    Resolution,
    StartedNode,
)
from kg.holes import ANONYMOUS, is_partial
from kg.launch.wiring.place import Place
from kg.launch.wiring.remapping import Remapping, rules_of
from kg.launch.wiring.simulation_table import (
    Device,
    End,
    Spawner,
    device_of,
    filled,
    read_end,
    simulator_of,
    spawner_of,
)
from kg.names import join, normalise

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.launch.wiring.instances import Draft

ORIGIN: Final = "gazebo plugin"
"""The origin of interfaces that the table tells."""
_DESCRIPTION: Final = "robot_description"


@dataclass(frozen=True, slots=True)
class Simulated:
    """A plugin that runs in an instance: with the namespace and model of the robot that it was loaded for."""

    plugin: LaunchPlugin
    row: Device
    repository: str
    namespace: str = ""
    model: str = ""

    def ends(self, node: Place, remapping: Remapping) -> Iterator[InstanceInterface]:
        """Return the ends that the plugin makes in the instance at `node`."""
        if self.row.ros == 1:
            return self._ends_at(self._handle_place(node), remapping)
        return self._ends_at(*self._own_node())

    def _values(self) -> dict[str, str]:
        values = {one.element: one.text for one in reversed(self.plugin.values)}
        return {**values, "plugin": self.plugin.name or "", "model": self.model}

    def _handle_place(self, node: Place) -> Place:
        """Return the place of the plugin's node handle (ROS 1)."""
        given = self._values().get("robotNamespace")
        namespace = self.namespace if given is None else given
        if not namespace and self.row.model:
            namespace = self.model
        return Place(node.resolve(namespace) if namespace else node.namespace, node.name, node.full)

    def _own_node(self) -> tuple[Place, Remapping]:
        """Return the place of the plugin's own node, and its rules (ROS 2); the simulator itself is at the root."""
        namespace = self._values().get("ros/namespace") or self.namespace
        place = Place(normalise(f"/{namespace}"), self.plugin.name or ANONYMOUS)
        remaps = []
        for one in self.plugin.values:
            source, mark, target = one.text.partition(":=")
            if one.element == "ros/remapping" and mark:
                remaps.append(Remap(source.strip(), target.strip(), one.location, self.plugin.chain))
        return place, Remapping(rules_of(remaps, place, self.row.ros), self.row.ros)

    def _ends_at(self, place: Place, remapping: Remapping) -> Iterator[InstanceInterface]:
        values = self._values()
        for each in self._each():
            now = values if each is None else {**values, "each": each}
            below = filled(self.row.below, now)
            for text in self.row.ends:
                end = read_end(text)
                name = filled(end.name, now)
                if below is not None and name and end.is_there(now):
                    yield self._end(end, (below, name), place, remapping)

    def _each(self) -> Sequence[str | None]:
        """Return the subjects of the ends, each one once."""
        if self.row.each is None:
            return (None,)
        texts = [one.text for one in self.plugin.values if one.element == self.row.each]
        if self.row.words:
            texts = [word for text in texts for word in [one for one in self.row.words if one in text][:1]]
        return tuple(dict.fromkeys(texts))

    def _end(self, end: End, names: tuple[str, str], place: Place, remapping: Remapping) -> InstanceInterface:
        below, name = names
        full = join(below, name)
        handle = (place.resolve(below) if below else place.namespace) if self.row.ros == 1 else None
        resolved, remap = place.resolve(full), None
        if not is_partial(resolved):
            resolved, remap = remapping.apply(resolved, end.role, handle)
        partial = is_partial(resolved)
        location, written = self._evidence(end)
        sure = Resolution.LITERAL if written is not None else Resolution.PARAMETER_DEFAULT
        reason = f"the plugin is there only if {self.plugin.condition}" if self.plugin.condition else None
        if partial:
            reason = "a part of it is known only at run time"
        declared = Interface(
            role=end.role,
            name=full,
            type=end.type,
            resolution=Resolution.PARTIAL if partial else sure,
            location=location,
            written=written,
            origin=ORIGIN,
            reason=reason,
        )
        library = self.plugin.library.rpartition("/")[2]
        owner = NodeReference(location.repository or self.repository, self.row.package, library)
        return InstanceInterface(declared, owner, resolved, declared.resolution, remap, reason=reason)

    def _evidence(self, end: End) -> tuple[Location, str | None]:
        """Return the line that gives the name: of the element, else of the plugin; and the text of the element."""
        for element in end.elements():
            found = next((one for one in self.plugin.values if one.element == element), None)
            if found is not None:
                return found.location, found.text
        return self.plugin.location, None


def simulate(drafts: Sequence[Draft], configuration: LaunchConfiguration) -> None:
    """Give the plugins of each description that is handed to a simulator to the instance that they run in."""
    if not configuration.plugins:
        return
    ros = configuration.ros
    runner = next((one for one in drafts if simulator_of(one.started.package, one.started.executable, ros)), None)
    for draft in drafts:
        spawner = spawner_of(draft.started.package, draft.started.executable, ros)
        if spawner is None:
            continue
        words = [word for argument in draft.started.arguments for word in argument.split()]
        namespace = _option(words, spawner.namespace) or (draft.place.namespace if ros == 1 else "")
        model = _option(words, spawner.model) or ""
        for plugin in _described_plugins(draft, spawner, words, configuration):
            row = device_of(plugin.library, ros)
            if row is not None:
                simulated = Simulated(plugin, row, configuration.repository, namespace, model)
                (runner or draft).simulated.append(simulated)


def _described_plugins(
    draft: Draft, spawner: Spawner, words: Sequence[str], configuration: LaunchConfiguration
) -> list[LaunchPlugin]:
    """Return the plugins of the description that a program hands over."""
    plugins = configuration.plugins
    named = _option(words, spawner.parameter)
    if named is not None:
        wanted = draft.place.resolve(named if configuration.ros == 1 else f"~/{named}")
        return [plugin for plugin in plugins if plugin.parameter == wanted]
    topic = _option(words, spawner.topic)
    if topic is None:
        return []
    above = draft.place.resolve(topic).rpartition("/")[0] or "/"
    names = {plugin.parameter for plugin in plugins if plugin.parameter.endswith(f"/{_DESCRIPTION}")}
    near = {name for name in names if (name.rsplit("/", 2)[0] or "/") == above} or (names if len(names) == 1 else set())
    return [plugin for plugin in plugins if plugin.parameter in near]


def _option(words: Sequence[str], names: Sequence[str]) -> str | None:
    """Return the word behind an option of a command line."""
    for word, following in pairwise(words):
        if word in names or (word.startswith("--") and word[1:] in names):
            return following
    return None


def own_ends(
    started: StartedNode, place: Place, remapping: Remapping, ros: int, repository: str
) -> Iterator[InstanceInterface]:
    """Yield the ends of a simulator itself, unless code of the build declares them."""
    row = simulator_of(started.package, started.executable, ros)
    if row is None:
        return
    owner = NodeReference(started.location.repository or repository, row.package, row.library)
    for text in row.ends:
        end = read_end(text)
        resolved, remap = remapping.apply(place.resolve(end.name), end.role)
        kind = Resolution.LITERAL
        declared = Interface(end.role, end.name, end.type, kind, started.location, origin=ORIGIN)
        yield InstanceInterface(declared, owner, resolved, kind, remap)
