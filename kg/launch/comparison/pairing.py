"""The pairing of things with the same name at both sides, or names that differ in the labels of their holes.

Canonical values of parameters and arguments: `30.` and `30.0` are one number.

Nodes are first paired by their names. Those that remain are paired by the place that starts them: the file with the
includes that lead to it, the program, and then the last part of the name, the line, or being the only candidate.
"""

from __future__ import annotations

import json
import re
from collections import Counter, defaultdict
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Final, TypeVar

import yaml

from kg.holes import anonymous
from kg.yamltext import load_yaml

if TYPE_CHECKING:
    from collections.abc import Sequence

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


_Thing = TypeVar("_Thing")

_EXPONENT: Final = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+")
"""A number for C++ and for ROS, a text for YAML 1.1 where it lacks the point or the sign."""
_LONGEST: Final = 10_000


def canonical(text: str) -> str:
    """Return the canonical spelling of a value written as YAML; other texts are returned unchanged.

    An integer differs from the equal floating point number, because parameters of ROS 2 are typed.
    """
    if len(text) > _LONGEST:
        return text
    if _EXPONENT.fullmatch(text.strip()):
        return repr(float(text))
    value = _read(text)
    if isinstance(value, str):
        return value if _read(value) == value else json.dumps(value, ensure_ascii=False)
    if isinstance(value, bool | int | float | list | dict):
        try:
            return json.dumps(value, ensure_ascii=False, sort_keys=True)
        except (TypeError, ValueError):  # dates, keys of several types
            return text
    return text


def _read(text: str) -> Any:
    try:
        return load_yaml(text, yaml.SafeLoader)
    except (yaml.YAMLError, ValueError, RecursionError):
        return text


def paired(
    before: Iterable[_Thing], after: Iterable[_Thing], key: Callable[[_Thing], Hashable]
) -> Iterator[tuple[_Thing | None, _Thing | None]]:
    """Yield pairs with the same key at both sides, in order; None for a side without a partner."""
    one, other = _numbered(before, key), _numbered(after, key)
    for name in sorted({*one, *other}, key=str):
        yield one.get(name), other.get(name)


def _numbered(things: Iterable[_Thing], key: Callable[[_Thing], Hashable]) -> Mapping[tuple[Hashable, int], _Thing]:
    seen: Counter[Hashable] = Counter()
    numbered = {}
    for thing in things:
        name = key(thing)
        seen[name] += 1
        numbered[name, seen[name]] = thing
    return numbered


def all_pairs(
    before: Iterable[_Thing],
    after: Iterable[_Thing],
    key: Callable[[_Thing], Hashable],
    *ways: Callable[[list[_Thing], list[_Thing]], Iterable[tuple[_Thing, _Thing]]],
) -> Iterator[tuple[_Thing | None, _Thing | None]]:
    """Yield all things in pairs: with the same key, then those that each of `ways` finds among what is left.

    None is a side without a partner.
    """
    gone: list[_Thing] = []
    new: list[_Thing] = []
    for one, other in paired(before, after, key):
        if one is not None and other is not None:
            yield one, other
        elif one is not None:
            gone.append(one)
        elif other is not None:
            new.append(other)
    for way in ways:
        pairs = list(way(gone, new))
        done = {id(thing) for pair in pairs for thing in pair}
        gone, new = ([thing for thing in things if id(thing) not in done] for things in (gone, new))
        yield from pairs
    yield from ((one, None) for one in gone)
    yield from ((None, other) for other in new)


def matched(
    before: Iterable[_Thing], after: Iterable[_Thing], key: Callable[[_Thing], Hashable | None], most: int = 1
) -> Iterator[tuple[_Thing, _Thing]]:
    """Yield pairs of one key, where both sides have equally many, at most `most`; a thing without a key has none."""
    groups: defaultdict[Hashable, tuple[list[_Thing], list[_Thing]]] = defaultdict(lambda: ([], []))
    for side, things in enumerate((before, after)):
        for thing in things:
            name = key(thing)
            if name is not None:
                groups[name][side].append(thing)
    for one, other in groups.values():
        if len(one) == len(other) <= most:
            yield from zip(one, other, strict=True)


def relabelled(
    one: Iterable[_Thing], other: Iterable[_Thing], key: Callable[[_Thing], tuple[str, ...]]
) -> Iterator[tuple[_Thing, _Thing]]:
    """Yield the pairs whose names are equal apart from the labels of unknown parts, which may change with the code."""
    for before, after in paired(one, other, lambda thing: tuple(map(anonymous, key(thing)))):
        if before is not None and after is not None:
            yield before, after
