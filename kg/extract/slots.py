"""The plugin slots of a node: which plugins it loads by which parameters, from the calls that load them."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.extract.declared import Home, evidence, with_slash
from kg.facts import PluginDefault, PluginSlot
from kg.holes import hole_of, partition
from kg.symbolic.values import Sequence, Text, Unknown, Value

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.symbolic.effects import Declared
    from kg.symbolic.plugins import Loading

_ELEMENT: Final = "[]"
_ID: Final = "{id}"
_PART: Final = re.compile(r"[^./]+")


def slots_of(loadings: Iterable[Loading], declared: Iterable[Declared], home: Home) -> tuple[PluginSlot, ...]:
    """Return the slots of a node, each once, from its loadings of plugins and its parameters.

    An object that loads plugins is a slot of its own if no call for its base class does. An element of a list that a
    call joins with the value of another parameter is not the class.
    """
    parameters = [one for one in declared if one.effect.access is not None]
    slots: dict[tuple[str | None, str | None, str | None], PluginSlot] = {}
    idle: dict[tuple[str | None, bool], PluginSlot] = {}
    for one in loadings:
        slot = _slot(one, parameters, home)
        if one.plugin is None and one.parameter is None:
            idle.setdefault((slot.base_class, slot.fixed), slot)
        elif slot.parameter or slot.defaults or slot.reason:
            key = (slot.base_class, slot.names, slot.parameter)
            slots[key] = _both(slots[key], slot) if key in slots else slot
    used = {base for base, _, _ in slots}
    named = {(slot.base_class, slot.location) for slot in slots.values() if _ID in (slot.parameter or "")}
    used_slots = (
        slot
        for slot in slots.values()
        if (slot.base_class, slot.location) not in named or not (slot.parameter or "").endswith(_ELEMENT)
    )
    return (*used_slots, *(slot for (base, _), slot in idle.items() if base not in used))


def _both(one: PluginSlot, other: PluginSlot) -> PluginSlot:
    defaults = tuple(sorted({*one.defaults, *other.defaults}, key=lambda each: (each.name or "", each.class_name)))
    return replace(one, defaults=defaults, fixed=one.fixed and other.fixed, reason=one.reason or other.reason)


def _slot(one: Loading, parameters: list[Declared], home: Home) -> PluginSlot:
    """Return the slot of one loading; an empty text in place of the class is neither a default nor unknown."""
    place, via = evidence(one.stack, home)
    empty = PluginSlot(one.base, place, one.names, one.parameter, fixed=one.fixed, via=via, reason=one.reason)
    if one.plugin is None:
        return empty if one.reason or one.parameter else replace(empty, reason="no call that loads a plugin was found")
    plugin = one.plugin.exact if isinstance(one.plugin, Text) else None
    given: str | None = getattr(one.plugin, "parameter", None)
    names, parameter, item = _named(given, parameters) if given is not None else (None, None, None)
    name = one.name.exact if isinstance(one.name, Text) else item
    defaults = (PluginDefault(plugin, name),) if plugin else ()
    fixed = bool(plugin) and parameter is None
    reason = _reason(one.plugin) if plugin is None else None
    return replace(empty, names=names, parameter=parameter, defaults=defaults, fixed=fixed, reason=reason)


def _reason(value: Value) -> str:
    if isinstance(value, Text):
        return value.reason or "it is known in part"
    return value.reason if isinstance(value, Unknown) else "it is not a text"


def _named(given: str, parameters: list[Declared]) -> tuple[str | None, str, str | None]:
    """Return the parameter with the names of plugins, the one with their class, and the name of this plugin.

    `given` is the parameter with the class of this plugin: `FollowPath.plugin`.
    """
    given = with_slash(given)
    if _ELEMENT in given:
        return given.partition(_ELEMENT)[0], given, None
    name = next((n for one in parameters if isinstance(n := one.name, Text) and with_slash(n.shown) == given), None)
    if name is not None and name.parameter is not None and name.parameter.endswith(_ELEMENT) and name.exact is None:
        before, _, after = partition(given, hole_of(name.parameter))
        return with_slash(name.parameter.removesuffix(_ELEMENT)), f"{before}{_ID}{after}", None
    parts = list(_PART.finditer(given))
    for one in sorted(parameters, key=lambda one: not isinstance(one.default, Sequence)):
        for item in one.default.items if isinstance(one.default, Sequence) else (one.default,):
            item_name = item.exact if isinstance(item, Text) else None
            part = next((part for part in parts if part[0] == item_name), None)
            if part is not None and isinstance(one.name, Text):
                return with_slash(one.name.shown), f"{given[: part.start()]}{_ID}{given[part.end() :]}", item_name
    return None, given, None
