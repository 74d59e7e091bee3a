"""The interfaces of an instance among those that its type may have: families, alternative names, and switches.

A name that is the value of a parameter `~/imu{}` stands for as many interfaces as parameters are set whose names fit
(`imu0`, `imu1`), one of `~/topics[].name` for as many as the list or dictionary `~/topics` has elements, and one of
`~/topics[key]` for as many as the dictionary has keys. Code that names one interface in several ways, by the arguments
or the namespace that it finds, has only one of them in an instance. Parameters turn
interfaces on and off: by a boolean, or by a value that selects parts (`~/type == scan`, `~/cameras > 1`), also for each
member of a family (`~/{sources}.type == scan`).
"""

from __future__ import annotations

import json
import operator
import re
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.facts import HOLDS, InstanceInterface, Interface, LaunchParameter, NodeType, Switch
from kg.holes import (
    Hole,
    anonymous,
    is_known,
    is_partial,
    known_letters,
    label_of,
    parse,
    partition,
    pattern,
    substitute,
)
from kg.launch.wiring.values import ARGUMENT, COMMAND_LINE, OPTION, Settings, is_text, parsed

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kg.launch.wiring.place import Place
    from kg.launch.wiring.plugins import Loaded

_COMPARE: Final = {"==": operator.eq, "<": operator.lt, ">": operator.gt, "<=": operator.le, ">=": operator.ge}
_EACH: Final = "[]"
_KEY: Final = "[key]"
_STEP: Final = re.compile(r"\[(?:key)?\]|\.[^.\[\]]+")
"""A step into a parameter: each element of a list or dictionary, each key of a dictionary, a member of an element."""


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
    open_name = is_partial(parameter)
    if "[" in anonymous(parameter) and not parameter.startswith(COMMAND_LINE):
        return ((None, None),) if open_name else list(_elements(parameter, declared, settings, place))
    if not open_name:
        setting = settings.get(parameter, place)
        return ((setting, setting),)
    parameters = {one.name for one in node.parameters if one.name is not None and one.name != parameter}
    own_text = settings.absolute(parameter, place)
    texts = (settings.absolute(name, place) for name in parameters)
    closer = [pattern(text) for text in texts if known_letters(text) > known_letters(own_text)]
    own = pattern(own_text)
    fitting = [
        (name, given)
        for name, given in settings.fitting(own, place)
        if (given.value is None or is_text(given.value)) and not any(other.fullmatch(name) for other in closer)
    ]
    if not fitting and declared.name is not None:
        return ((None, None),)
    switches = [Switch.parse(one) for one in declared.switches if is_partial(one)]
    names = []
    for name, given in sorted(fitting, key=lambda pair: _natural(pair[0])):
        member = _hole_value(own_text, name)
        listed = all(_is_listed(value, label, node, settings, place) for label, value in member.items())
        named = ((one, substitute(one.parameter, member.get)) for one in switches)
        if listed and not any(_is_on(one, node, settings, name, place) is False for one, name in named):
            names.append((given, given))
    return names


def _hole_value(family: str, name: str) -> Mapping[str, str]:
    """Return the text that a member has for the hole of its family, if the family has one labelled hole."""
    labels = list(dict.fromkeys(part.label for part in parse(family) if isinstance(part, Hole)))
    match = pattern(family).fullmatch(name)
    return {labels[0]: match[1]} if len(labels) == 1 and labels[0] and match and match.groups() else {}


def _is_listed(member: str, label: str, node: NodeType, settings: Settings, place: Place) -> bool:
    """Check whether the parameter with the names of a family's members lists a member, or is not known."""
    sources = [one.name for one in node.parameters if one.name is not None and label_of(one.name) == label]
    given = settings.get(sources[0], place) if len(sources) == 1 else None
    names = parsed(given.value) if given is not None else None
    return not isinstance(names, list) or member in names


def _elements(
    parameter: str, declared: Interface, settings: Settings, place: Place
) -> Iterator[tuple[LaunchParameter | None, LaunchParameter | None]]:
    """Yield the texts that a part of a parameter means (`~/topics[].name`), each with the parameter that holds it.

    One that is not known stands for a value that is not; what a dictionary lacks has the default of the code if any.
    """
    base = parameter.partition("[")[0]
    whole = settings.tree(base, place)
    for text, holder in _walk(whole, _STEP.findall(parameter[len(base) :]), None):
        if holder is None:
            if text is None and is_known(declared.name):
                yield None, None
        else:
            yield replace(holder, value=None if text is None else json.dumps(text)), holder


def _walk(
    value: object, steps: Sequence[str], holder: LaunchParameter | None
) -> Iterator[tuple[str | None, LaunchParameter | None]]:
    """Yield the texts at the end of `steps` in a value; no text and no parameter for a member that is not there."""
    if isinstance(value, LaunchParameter):
        holder, value = value, parsed(value.value)
        if holder.value is None:
            yield None, holder
            return
    if not steps:
        if isinstance(value, str):
            yield value, holder
        return
    step, rest = steps[0], steps[1:]
    if step == _EACH and isinstance(value, str) and holder is not None:  # a list written as one text
        value = re.split(r"[\s,;]+", value.strip()) if value.strip() else []
    if step == _EACH and isinstance(value, list):
        for element in value:
            yield from _walk(element, rest, holder)
    elif step == _EACH and isinstance(value, dict):
        named = [leaf for element in value.values() for leaf in _walk(element, rest, holder)]
        yield from named if named or rest else _walk(value, [_KEY], holder)
    elif step == _KEY and isinstance(value, dict):
        for key, element in value.items():
            yield str(key), holder or _first(element)
    elif step.startswith("."):
        inner = value.get(step[1:]) if isinstance(value, dict) else None
        if inner is None:
            yield None, None
        else:
            yield from _walk(inner, rest, holder)
    elif value is not None:
        yield None, holder


def _first(value: object) -> LaunchParameter | None:
    """Return the first parameter of a tree of them."""
    while isinstance(value, dict) and value:
        value = next(iter(value.values()))
    return value if isinstance(value, LaunchParameter) else None


def effective(interfaces: Iterable[Interface], settings: Settings) -> list[Interface]:
    """Return the interfaces that an instance makes, without those whose place at the same line another has.

    A name that falls back to an earlier argument of the command line does so where a later one is not given, and one
    that is absolute where the code puts the node's namespace in front of it else is that of the root namespace.
    One that an option gives is there with the option, others of that line without it.
    """
    listed = _by_options([one for one in interfaces if one.arguments <= settings.arguments], settings)
    last: dict[tuple[object, ...], int] = {}
    relative = set()
    for one in listed:
        index = _argument(one)
        if index is not None and index <= settings.arguments:
            last[_line(one)] = max(index, last.get(_line(one), 0))
        if one.name is not None and not one.implicit:
            relative.add((*_line(one), one.type, one.name))
    chosen = []
    for one in listed:
        index, newest = _argument(one), last.get(_line(one))
        if index is not None and newest is not None and index != newest:
            continue
        name = one.name or ""
        if name.startswith("/") and (*_line(one), one.type, name[1:]) in relative:
            continue
        chosen.append(one)
    return chosen


def _by_options(interfaces: list[Interface], settings: Settings) -> list[Interface]:
    """Return interfaces without those that an option of the command line rules out at their line.

    Code that ends what an option gives with a slash where there is none has both forms: only the one with it is meant.
    """
    of_option = {id(one): settings.word(one.parameter or "") for one in interfaces if OPTION.match(one.parameter or "")}
    if not of_option:
        return interfaces
    given = {_end(one) for one in interfaces if of_option.get(id(one)) is not None}
    without = {_end(one) for one in interfaces if id(one) not in of_option}
    forms = {(_end(one), one.name) for one in interfaces if id(one) in of_option}

    def excluded(one: Interface) -> bool:
        if id(one) not in of_option:
            return _end(one) in given
        word = of_option[id(one)]
        if word is None:
            return _end(one) in without
        before, hole, after = partition(one.name or "")
        slashed = after.startswith("/")
        other = before + hole + (after[1:] if slashed else f"/{after}")
        return bool(hole) and slashed is word.endswith("/") and (_end(one), other) in forms

    return [one for one in interfaces if not excluded(one)]


def _line(one: Interface) -> tuple[object, ...]:
    return one.role, one.location


def _end(one: Interface) -> tuple[object, ...]:
    return one.role, one.location, one.type


def _argument(one: Interface) -> int | None:
    match = ARGUMENT.fullmatch(one.parameter or "")
    return int(match[1]) if match is not None else None


def _natural(name: str) -> list[tuple[int, str]]:
    """Return a key that sorts `imu2` before `imu10`."""
    return [(int(part), "") if part.isdigit() else (0, part) for part in re.split(r"(\d+)", name)]


def switched_on(
    node: NodeType, settings: Settings, place: Place, plugin: Loaded | None = None
) -> tuple[NodeType, Mapping[Interface, tuple[str, ...]]]:
    """Return a node type without the interfaces that parameters, as they are set or by default, keep from being made.

    `place` is that of the node; `plugin` is the plugin whose type it is, if any. Of the interfaces that are left, the
    second result has those that might not be made either, with the switches whose parameters are unknown.
    """
    if not any(one.switches for one in node.interfaces):
        return node, {}
    left: list[Interface] = []
    doubtful: dict[Interface, tuple[str, ...]] = {}
    for one in node.interfaces:
        undecided: list[str] = []
        for written in one.switches:
            switch = Switch.parse(written)
            name, at = (switch.parameter, place) if plugin is None else plugin.read_as(switch.parameter, place)
            on = _is_on(switch, node, settings, name, at)
            if on is False:
                break
            if on is None and not is_partial(name):
                undecided.append(written)
        else:
            left.append(one)
            if undecided:
                doubtful[one] = tuple(sorted(undecided))
    return replace(node, interfaces=tuple(left)), doubtful


def marked(
    ends: Iterable[InstanceInterface], doubtful: Mapping[Interface, tuple[str, ...]]
) -> Iterable[InstanceInterface]:
    """Return ends with the switches that are undecided for their interfaces."""
    if not doubtful:
        return ends
    return (replace(end, switches=doubtful.get(end.declared, ())) for end in ends)


def _is_on(switch: Switch, node: NodeType, settings: Settings, name: str, place: Place) -> bool | None:
    """Return whether a switch is on; None if no parameter decides it, or its parameter, read as `name`, is unknown."""
    if switch.sign == HOLDS:
        return None
    if is_partial(name) and any(settings.fitting(pattern(settings.absolute(name, place)), place)):
        return None
    setting = settings.get(name, place)
    if setting is None and settings.has_unread(place) and not name.startswith(COMMAND_LINE):
        return None
    if switch.sign == "is":  # set
        return setting is not None
    if setting is not None:
        fulfilled = _holds(switch, setting.value)
    elif ARGUMENT.fullmatch(name):
        fulfilled = False
    else:
        named = (one for one in node.parameters if one.name == switch.parameter and one.default is not None)
        defaults = {_holds(switch, one.default) for one in named}
        fulfilled = defaults.pop() if len(defaults) == 1 else None
    return None if fulfilled is None else fulfilled is switch.wanted


def _holds(switch: Switch, value: str | None) -> bool | None:
    """Return whether a value is the one of a switch, or true; None for one that is not known."""
    if switch.value is None:  # a boolean, or a text that turns something on unless it is empty
        actual = "" if value is not None and not value.strip() else parsed(value)
        if isinstance(actual, str):
            return None if "{" in actual else actual != ""
        return actual if isinstance(actual, bool) else None
    actual = parsed(value)
    if isinstance(actual, bool) or not isinstance(actual, (str, int, float)) or "{" in str(actual):
        return None
    wanted = parsed(switch.value)
    if not isinstance(actual, str) and isinstance(wanted, (int, float)):
        return bool(_COMPARE[switch.sign](actual, wanted))
    if switch.sign != "==":
        return None
    same = str(actual) == switch.value
    # Code often folds the case before it compares.
    return same if same or str(actual).casefold() != switch.value.casefold() else None
