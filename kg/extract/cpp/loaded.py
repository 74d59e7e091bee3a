"""Nodelets that a program loads into itself by name: `nodelet::Loader::load(name, "package/Type", remappings, ...)`.

Source: nodelet/loader.h. Their interfaces are those of the loading node, with the remappings it gives them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kg.extract.cpp import syntax
from kg.extract.cpp.context import EMPTY
from kg.extract.cpp.sites import call_around
from kg.extract.cpp.unit import Expr
from kg.extract.values import Mapping, Text
from kg.names import normalise

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.extract.cpp.evaluate import Evaluator
    from kg.extract.values import Value

__all__ = ["Loaded", "loaded_nodelets"]

_TYPE = 1
_REMAPPINGS = 2


@dataclass(frozen=True, slots=True)
class Loaded:
    """One load: the plugin's name and the names that it is given instead of its own.

    `own` tells that the nodelet bears the name of the loading node, so that their private names are the same.
    """

    plugin: str
    own: bool
    remappings: tuple[tuple[str, str], ...]

    def renamed(self, name: str | None) -> str | None:
        """Return the name that an interface called `name` has in the loading node."""
        return dict(self.remappings).get(name, name) if name is not None else None


def loaded_nodelets(evaluator: Evaluator) -> Iterator[Loaded]:
    """Yield the nodelets that reached code loads; those whose type is not known are left out."""
    if not any(b"nodelet::Loader" in unit.source for unit in evaluator.program.units.values()):
        return
    seen = set()
    for unit, node in evaluator.program.sites("load"):
        call = call_around(node)
        given = syntax.arguments(call.child_by_field_name("arguments")) if call is not None else []
        if len(given) <= _TYPE:
            continue
        evaluator.restart()
        exprs = [Expr.of(unit, argument) for argument in given[: _REMAPPINGS + 1]]
        for values, _ in evaluator.product(exprs, EMPTY):
            name, kind = (value.known if isinstance(value, Text) else None for value in values[: _TYPE + 1])
            if kind is None or "/" not in kind:
                continue
            found = Loaded(kind, name == "~", tuple(_pairs(values[_REMAPPINGS])) if len(values) > _REMAPPINGS else ())
            if found not in seen:
                seen.add(found)
                yield found


def _pairs(value: Value) -> Iterator[tuple[str, str]]:
    for key, given in value.items if isinstance(value, Mapping) else ():
        old = key.known if isinstance(key, Text) else None
        new = given.known if isinstance(given, Text) else None
        if old is not None and new is not None:
            yield normalise(old), normalise(new)
