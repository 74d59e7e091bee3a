"""The views by the names that faces call them by; the module of a view is loaded when it is first called."""

from __future__ import annotations

from importlib import import_module
from inspect import Parameter, signature
from typing import TYPE_CHECKING, Any, Final, get_type_hints

import msgspec

from kg.errors import QueryError

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

_NAMES: Final = {
    "Any": Any,
    "EmbeddedSnapshot": Any,
    "Mapping": dict,
    "Sequence": list,
    "Settings": Any,
    "Snapshot": Any,
}
"""What the annotations of views mean for what JSON can hold; some of them are imported for type checkers only."""


class View:
    """A function of a module of `kg.views`, called with arguments by name; QueryError KG505 when they do not fit."""

    def __init__(self, module: str, name: str) -> None:
        self.module = f"kg.views.{module}"
        self._name = name

    @property
    def function(self) -> Callable[..., Any]:
        """The function itself, whose module is loaded now."""
        function: Callable[..., Any] = getattr(import_module(self.module), self._name)
        return function

    def __call__(self, snapshot: EmbeddedSnapshot, settings: Settings, /, **arguments: Any) -> Any:
        """Return the result of the view."""
        function = self.function
        kinds = get_type_hints(function, localns=_NAMES)
        try:
            given = signature(function).bind(snapshot, settings, **arguments)
            for name, value in given.arguments.items():
                extra = given.signature.parameters[name].kind is Parameter.VAR_KEYWORD
                msgspec.convert(value, dict[str, kinds[name]] if extra else kinds[name])  # type: ignore[valid-type]  # read now
        except (TypeError, msgspec.ValidationError) as error:
            raise QueryError("KG505", f"the view `{self._name}` cannot be called like that: {error}") from None
        return function(snapshot, settings, **arguments)


CALLS: Final[dict[str, View]] = {
    "about": View("resource", "about"),
    "blocks": View("rule_vocabulary", "blocks"),
    "blocks_check": View("rule_blocks", "blocks_check"),
    "blocks_open": View("rule_blocks", "blocks_open"),
    "blocks_try": View("rule_blocks", "blocks_try"),
    "capabilities": View("robot", "capabilities"),
    "cells": View("cells", "cells"),
    "channel": View("channel", "channel"),
    "choices": View("find", "choices"),
    "complete": View("complete", "complete"),
    "diagnose": View("complete", "diagnose"),
    "find": View("find", "find"),
    "impact": View("impact", "impact"),
    "lint": View("system", "lint"),
    "list": View("lists", "listing"),
    "node": View("node", "node"),
    "overview": View("overview", "overview"),
    "parameter": View("parameter", "parameter"),
    "place": View("cells", "place"),
    "prefixes": View("complete", "prefixes"),
    "prepare": View("overview", "prepare"),
    "resource": View("resource", "resource"),
    "rule": View("rules", "rule"),
    "rule_feeds": View("rules", "rule_feeds"),
    "rule_index": View("rules", "rule_index"),
    "rules": View("rules", "rules"),
    "stored": View("stored", "stored"),
    "system": View("system", "system"),
    "systems": View("systems", "systems"),
    "tree": View("tree", "tree"),
    "why": View("why", "why"),
    "why_not": View("why", "why_not"),
    "why_row": View("why", "why_row"),
}
"""Name to function."""

MODULES: Final = tuple(sorted({view.module for view in CALLS.values()}))
"""What readers load while there is nothing else to do, so that new ones need not."""
