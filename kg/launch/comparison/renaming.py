"""Renamed nodes of a launch file: their pairs, and the changes that only follow from the renaming.

Nodes are first paired by their names. Those that remain are paired by the place that starts them: the file with the
includes that lead to it, the program, and then the last part of the name, the line, or being the only candidate.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from functools import cached_property, partial
from typing import TYPE_CHECKING, Final

from kg.launch.comparison.pairing import all_pairs, matched

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence

    from kg.facts import NodeInstance

_Pair = tuple["NodeInstance | None", "NodeInstance | None"]


class Renames:
    """Changed prefixes of names, as `/rover1` to `/rover2`, with the number of nodes below each."""

    def __init__(self, pairs: Iterable[_Pair] = ()) -> None:
        nodes: defaultdict[tuple[str, str], list[tuple[NodeInstance, NodeInstance]]] = defaultdict(list)
        for one, other in pairs:
            if one and other and one.name != other.name:
                nodes[_beginnings(one.name, other.name)].append((one, other))
        self.nodes: Mapping[tuple[str, str], Sequence[tuple[NodeInstance, NodeInstance]]] = nodes
        self.names: Counter[tuple[str, str]] = Counter()

    def neutral(self, text: str) -> str:
        """Return a text that is equal for both names of a renamed node."""
        if self._pattern is None:
            return text
        return self._pattern.sub(lambda match: self._signs[match[0]], text)

    def follows(self, before: str, after: str) -> bool:
        """Return whether a name differs only by a renaming; such names are counted."""
        if before == after or self.neutral(before) != self.neutral(after):
            return False
        led = [pair for pair in self.nodes if before.startswith(pair[0]) and after.startswith(pair[1])]
        if led:
            self.names[max(led, key=lambda pair: (len(pair[0]) + len(pair[1]), sorted(pair)))] += 1
        return True

    @cached_property
    def _signs(self) -> Mapping[str, str]:
        """The sign of each prefix: one for both names, nothing if one of the names is the root."""
        signs: dict[str, str] = {}
        for number, names in enumerate(sorted(tuple(sorted(names)) for names in self.nodes)):
            for name in filter(None, names):
                signs.setdefault(name, f"\0{number}" if all(names) else "")
        return signs

    @cached_property
    def _pattern(self) -> re.Pattern[str] | None:
        names = sorted(self._signs, key=lambda name: (-len(name), name))
        return re.compile(rf"(?<![\w/}}])(?:{'|'.join(map(re.escape, names))})(?![\w{{])") if names else None


def instance_pairs(before: Iterable[NodeInstance], after: Iterable[NodeInstance]) -> Iterator[_Pair]:
    """Yield the pairs of nodes, None for a side without the node."""

    def alike(
        gone: list[NodeInstance], new: list[NodeInstance], *, key: Callable[[NodeInstance], Hashable], most: int
    ) -> Iterator[tuple[NodeInstance, NodeInstance]]:
        return matched(sorted(gone, key=_place), sorted(new, key=_place), key, most)

    ways = [partial(alike, key=key, most=most) for key, most in _WAYS]
    yield from all_pairs(sorted(before, key=_place), sorted(after, key=_place), lambda one: one.name, *ways)


def _started(instance: NodeInstance) -> tuple[Hashable, ...]:
    started = instance.started
    files = (*(one.path for one in started.chain), started.location.path)
    return files, started.kind, instance.started_type


def _called(instance: NodeInstance) -> Hashable:
    return *_started(instance), instance.name.rpartition("/")[2]


def _standing(instance: NodeInstance) -> Hashable:
    return *_started(instance), instance.started.chain, instance.started.location


_WAYS: Final[tuple[tuple[Callable[[NodeInstance], Hashable], int], ...]] = (
    (_called, 1_000),
    (_standing, 1_000),
    (_started, 1),
)


def _place(instance: NodeInstance) -> tuple[object, ...]:
    location = instance.started.location
    return location.path, location.line, instance.name, repr(instance)


def _beginnings(before: str, after: str) -> tuple[str, str]:
    """Return two names without their common suffix."""
    one, other = before.split("/"), after.split("/")
    while one and other and one[-1] == other[-1]:
        one.pop()
        other.pop()
    return "/".join(one), "/".join(other)
