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


_MODULES: Final = {
    "cells": "cells place",
    "channel": "channel",
    "complete": "complete diagnose prefixes",
    "find": "choices find",
    "impact": "impact",
    "named": "named",
    "node": "node",
    "overview": "overview prepare",
    "parameter": "parameter",
    "resource": "about resource",
    "robot": "capabilities",
    "rule_blocks": "blocks_check blocks_open blocks_try",
    "rule_vocabulary": "blocks",
    "rules": "rule rule_feeds rule_index rules",
    "stored": "stored",
    "system": "lint system",
    "systems": "systems",
    "tree": "tree",
    "why": "why why_not why_row",
}
"""The views of each module by the names of their functions."""
CALLS: Final[dict[str, View]] = {
    "list": View("listing", "listing"),
    **{name: View(module, name) for module, names in _MODULES.items() for name in names.split()},
}
"""Name to function."""

MODULES: Final = tuple(sorted({view.module for view in CALLS.values()}))
"""What readers load while there is nothing else to do, so that new ones need not."""
