"""Which interfaces an instance has of those that its type may have: families, and names that take turns.

A name that is the value of a parameter `~/imu{}` stands for as many interfaces as parameters are set whose names fit
(`imu0`, `imu1`), and one of `~/topics[].name` for as many as the list `~/topics` has elements. Code that names one
interface in several ways, by the arguments or the namespace that it finds, has only one of them in an instance.
"""

from __future__ import annotations

import json
import re
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Final

from kg.wiring.values import ARGUMENT, is_text, parsed

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kg.facts import Interface, LaunchParameter, NodeType
    from kg.wiring.place import Place
    from kg.wiring.values import Settings

__all__ = ["meant", "members"]

_HOLE: Final = "{}"
_EACH: Final = "[]"


def members(
    declared: Interface, node: NodeType, settings: Settings, place: Place
) -> Sequence[tuple[LaunchParameter | None, LaunchParameter | None]]:
    """Return the values that give names to an interface, each with the parameter that holds it.

    Both are one and the same unless the value is part of a parameter, and None where the interface keeps its own name.
    A parameter belongs to the family whose pattern leaves the least open: `imu0_config` is none of `imu{}` where the
    node asks for `imu{}_config` as well.
    """
    parameter = declared.parameter
    if parameter is None:
        return ((None, None),)
    if _EACH in parameter:
        whole = settings.get(parameter.partition(_EACH)[0], place)
        return [(part, whole) for part in _parts(parameter, whole)] if whole is not None else []
    if _HOLE not in parameter:
        found = settings.get(parameter, place)
        return ((found, found),)
    asked = {one.name for one in node.parameters if one.name is not None and one.name != parameter}
    others = [pattern_of(settings.absolute(name, place)) for name in asked]
    own = pattern_of(settings.absolute(parameter, place))
    fitting = [
        (name, given)
        for name, given in settings.fitting(own, place)
        if (given.value is None or is_text(given.value))
        and not any(len(other.pattern) > len(own.pattern) and other.fullmatch(name) for other in others)
    ]
    if not fitting and declared.name is not None:
        return ((None, None),)
    return [(given, given) for _, given in sorted(fitting, key=lambda pair: _natural(pair[0]))]


def _parts(parameter: str, whole: LaunchParameter) -> Iterator[LaunchParameter]:
    """Yield the texts in the elements of a list that `~/topics[].name` means; one not known if the list is not."""
    _, _, member = parameter.partition(_EACH)
    value = parsed(whole.value)
    if not isinstance(value, list):
        yield replace(whole, value=None)
        return
    for index, element in enumerate(value):
        text = element
        for key in member.split(".")[1:]:
            text = text.get(key) if isinstance(text, dict) else None
        if isinstance(text, str):
            yield replace(whole, name=f"{whole.name}[{index}]{member}", value=json.dumps(text))


def meant(interfaces: Iterable[Interface], settings: Settings) -> list[Interface]:
    """Return the interfaces that an instance makes, without those whose place at the same line another has.

    A name that falls back to an earlier argument of the command line does so where a later one is not given, and one
    that is absolute where the code puts the node's namespace in front of it else is that of the root namespace.
    """
    listed = [one for one in interfaces if one.arguments <= settings.arguments]
    last: dict[tuple[object, ...], int] = {}
    relative = set()
    for one in listed:
        index = _argument(one)
        if index is not None and index <= settings.arguments:
            last[_line(one)] = max(index, last.get(_line(one), 0))
        if one.name is not None and not one.implicit:
            relative.add((*_line(one), one.type, one.name))
    kept = []
    for one in listed:
        index, newest = _argument(one), last.get(_line(one))
        if index is not None and newest is not None and index != newest:
            continue
        name = one.name or ""
        if name.startswith("/") and (*_line(one), one.type, name[1:]) in relative:
            continue
        kept.append(one)
    return kept


@lru_cache(maxsize=4096)
def pattern_of(name: str) -> re.Pattern[str]:
    """Return what fits a name with holes, each of which is within one segment."""
    return re.compile(r"[^/.]+".join(re.escape(part) for part in name.split(_HOLE)))


def _line(one: Interface) -> tuple[object, ...]:
    return one.role, one.location


def _argument(one: Interface) -> int | None:
    found = ARGUMENT.fullmatch(one.parameter or "")
    return int(found[1]) if found is not None else None


def _natural(name: str) -> list[tuple[int, str]]:
    """Return a key that sorts `imu2` before `imu10`."""
    return [(int(part), "") if part.isdigit() else (0, part) for part in re.split(r"(\d+)", name)]
