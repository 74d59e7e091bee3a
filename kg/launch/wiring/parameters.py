"""Which parameters of a node those that a configuration sets are, and which they may have been meant to be."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

from kg.facts import Access, InstanceParameter, LaunchParameter, NodeReference, NodeType, Parameter
from kg.holes import fits, is_partial
from kg.launch.wiring.plugins import Loaded, below_id
from kg.launch.wiring.similar_names import Alike

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.launch.wiring.place import Place
    from kg.launch.wiring.remapping import Remapping

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
