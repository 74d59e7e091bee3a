"""The pairing of things with the same name at both sides, or names that differ in the labels of their holes.

Canonical values of parameters and arguments: `30.` and `30.0` are one number.
"""

from __future__ import annotations

import json
import re
from collections import Counter, defaultdict
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from typing import Any, Final, TypeVar

import yaml

from kg.holes import anonymous
from kg.yamltext import load_yaml

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
