"""Plugins that framework calls load: the class that they are loaded as, and what gives their own class."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.holes import ANONYMOUS, parse
from kg.symbolic.names import below, namespace_of
from kg.symbolic.values import Object, Text, TypeValue, Value

if TYPE_CHECKING:
    from kg.symbolic.descriptions import SlotDescription
    from kg.symbolic.state import Invocation, Site

_ARGUMENT: Final = re.compile(r"\{(\d+)\}")
_PLACE: Final = re.compile(r"\{(\d+|T)\}")


@dataclass(frozen=True, slots=True)
class Loading:
    """A call that loads plugins of a `base` class, with the node whose code makes it.

    `plugin` and `name` are the class and the name of one plugin, as far as arguments give them; `parameter` and `names`
    the parameters that do. A call with none of them creates the object that loads them.
    """

    base: str | None
    node: Object | None
    stack: tuple[Site, ...]
    plugin: Value | None = None
    name: Value | None = None
    parameter: str | None = None
    names: str | None = None
    reason: str | None = None
    fixed: bool = False
    """Whether the code names what runs: code outside of the sources that gets the node."""


def loading(slot: SlotDescription, call: Invocation, node: Object | None, stack: tuple[Site, ...]) -> Loading:
    """Return what a described call loads; an object that it creates keeps the base class for its methods."""
    inherited = call.node.native.get("base") if isinstance(call.node, Object) else None
    base = _filled(slot.base, call) if slot.base is not None else _template(call)
    if slot.base is None and isinstance(inherited, Text):
        base = inherited.exact
    return Loading(
        base,
        node,
        stack,
        call.argument(slot.plugin),
        call.argument(slot.name),
        _parameter(slot.parameter, call),
        _parameter(slot.names, call),
        slot.reason,
    )


def _template(call: Invocation) -> str | None:
    """Return the first template argument of a call, or of the class of its object."""
    given = call.arguments.template or (call.kind.arguments if call.kind is not None else ())
    return "::".join(given[0].kind.names) if given and isinstance(given[0], TypeValue) else None


def _filled(pattern: str, call: Invocation) -> str | None:
    """Return the base class with its arguments; None if one of them is not known."""
    template = _template(call)
    values = {"T": template}
    for number in _ARGUMENT.findall(pattern):
        given = call.argument(int(number))
        values[number] = given.exact if isinstance(given, Text) else template
    if any(f"{{{key}}}" in pattern and value is None for key, value in values.items()):
        return None
    return _PLACE.sub(lambda match: str(values[match[1]]), pattern)


def _parameter(pattern: str | None, call: Invocation) -> str | None:
    """Return the name of a parameter below the namespace of the node or handle of a call."""
    if pattern is None:
        return None
    values = {number: call.argument(int(number)) for number in _ARGUMENT.findall(pattern)}
    texts = {number: value.shown if isinstance(value, Text) else ANONYMOUS for number, value in values.items()}
    filled = _ARGUMENT.sub(lambda match: texts[match[1]], pattern)
    whole = below(namespace_of(call.node), Text(parse(filled.removeprefix(".")) or ("",)))
    return whole.shown if isinstance(whole, Text) else None
