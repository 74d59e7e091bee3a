"""The names that a need can be about: message types, licences, and the labels of hardware, functions, capabilities."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Final

from kg.search.words import phrase

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from kg.search.reading import Concept

__all__ = ["ROLES", "Names"]

ROLES: Final = ("subscribes", "publishes", "services", "clients", "action_servers", "action_clients")


class Names:
    """The names of the features of an index."""

    def __init__(self, features: Iterable[str], concepts: Sequence[Concept]) -> None:
        self._types: defaultdict[str, defaultdict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
        self._licenses: dict[str, str] = {}
        self.features = frozenset(features)
        for feature in sorted(self.features):
            kind, _, name = feature.partition(":")
            if kind in ROLES and name:
                self._types[kind][name].append(feature)
                self._types[kind][name.rpartition("/")[2]].append(feature)
            elif kind == "license":
                self._licenses[name.lower()] = feature
        self.concepts: Mapping[tuple[str, ...], tuple[str, ...]] = self._concepts(concepts)

    def types(self, kind: str, name: str) -> tuple[str, ...]:
        """Return the features of a type: `LaserScan`, `sensor_msgs/LaserScan` or `sensor_msgs/msg/LaserScan`."""
        package, _, last = name.rpartition("/")
        package = package.partition("/")[0]
        return tuple(self._types[kind].get(f"{package}/{last}" if package else last, ()))

    def licenses(self, name: str) -> tuple[str, ...]:
        """Return the licences whose name begins with `name`, whatever its case: BSD is any of the BSD licences."""
        start = name.lower()
        return tuple(feature for known, feature in self._licenses.items() if _begins(known, start))

    def _concepts(self, concepts: Sequence[Concept]) -> dict[tuple[str, ...], tuple[str, ...]]:
        found: defaultdict[tuple[str, ...], list[str]] = defaultdict(list)
        for concept in concepts:
            feature = f"{concept.kind}:{concept.label}"
            if feature in self.features:
                for label in (concept.label, *concept.others):
                    found[phrase(label)].append(feature)
        return {stems: tuple(dict.fromkeys(features)) for stems, features in found.items() if stems}


def _begins(known: str, start: str) -> bool:
    return known.startswith(start) and not known[len(start) : len(start) + 1].isalpha()
