"""Where objects are made that no construction names: elements of containers, and bases of the object spoken about."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.cpp import syntax
from kg.extract.cpp.context import Site
from kg.extract.cpp.sites import call_around, fits
from kg.extract.cpp.unit import Class, Expr

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.extract.cpp.context import Context
    from kg.extract.cpp.evaluate import Evaluator
    from kg.extract.cpp.program import Program
    from kg.extract.cpp.unit import Function

__all__ = ["OBJECT", "emplaced", "of_object"]

OBJECT: Final = "object"
"""The choice of the class whose object is spoken about."""
_EMPLACING: Final = frozenset({"emplace_back", "emplace_front", "emplace"})


def of_object(program: Program, found: list[Site], cls: Class, context: Context) -> list[Site]:
    """Return the constructions of a base class that the object which is spoken about makes, if it makes one."""
    whole = context.get(OBJECT)
    if not isinstance(whole, Class) or whole is cls:
        return found
    family = [one for one in program.family(whole) if one is not cls]
    around = [site.where.unit.function_at(site.where.at) for site in found]
    own = [site for site, function in zip(found, around, strict=True) if function and program.owner(function) in family]
    return own or found


def emplaced(evaluator: Evaluator, function: Function, cls: Class, context: Context) -> Iterator[tuple[Site, Context]]:
    """Yield where a constructor makes elements of containers: `list.emplace_back(arguments)`."""
    types = evaluator.types
    for word in sorted(_EMPLACING):
        for unit, node in evaluator.program.sites(word):
            call = call_around(node)
            written = call.child_by_field_name("function") if call is not None else None
            called = syntax.callee(written) if written is not None else None
            if call is None or called is None or called.receiver is None:
                continue
            given = tuple(Expr.of(unit, one) for one in syntax.arguments(call.child_by_field_name("arguments")))
            kind = types.of(Expr.of(unit, called.receiver), context) if fits(function, len(given)) else None
            for held, chosen in types.settle(kind.arguments[0], context) if kind and kind.arguments else ():
                if types.class_of(held) is cls:
                    site = Site(Expr.of(unit, call), given)
                    yield site, chosen.bind(function, site)
