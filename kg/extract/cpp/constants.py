"""Where the value of a name outside of functions comes from: constants, global variables and macros."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.extract.cpp.flow import settled, unfinished
from kg.extract.cpp.unit import Expr, Unit
from kg.extract.cpp.variables import WriteKind, writes
from kg.extract.values import Text, Unknown

if TYPE_CHECKING:
    from kg.extract.cpp.context import Context
    from kg.extract.cpp.evaluate import Alternatives, Evaluator
    from kg.extract.cpp.variables import Write

__all__ = ["Constants"]


class Constants:
    """Follows names at namespace scope for an evaluator."""

    def __init__(self, evaluator: Evaluator) -> None:
        self._evaluator = evaluator
        self._program = evaluator.program
        self._flow = evaluator.flow

    def find(self, name: str, scope: tuple[str, ...], where: Expr, context: Context) -> Alternatives:
        """Return what a constant, global variable or macro holds."""
        if scope:
            cls = self._program.find_class(scope[-1], where.unit, scope[:-1])
            if cls is not None and name in cls.fields:
                found = self._flow.left([cls], name, context) or self._flow.initial(cls, name, context)
                if found and not unfinished(found):
                    return _through(found)
        for unit in (where.unit, *self._program.project.find(where.unit.file, name)):
            found = self._global(unit, name, where, context)
            if found:
                return _through(found)
        return [(Unknown(f"{name} is not in the sources that were read"), context)]

    def _global(self, unit: Unit, name: str, where: Expr, context: Context) -> Alternatives:
        macro = unit.macros.get(name)
        if macro is not None:
            return self._macro(unit, name, where, context)
        key = ("global", unit, name)
        if context.get(key):
            return []
        inner = context.bind(key, True)
        declared = [w for w in _outside(unit, name) if w.type is not None]
        if not declared:
            return []
        shared = any((write.node.text or b"").startswith(b"extern") for write in declared)
        units = tuple(self._program.units.values()) if shared else dict.fromkeys((unit, where.unit))
        found = [pair for other in units for pair in self._left_outside(other, name, where, inner)]
        if not found or unfinished(found):
            values = (
                w for other in units for w in _outside(other, name) if not (shared and w.kind is WriteKind.DECLARE)
            )
            found += [pair for write in values for pair in self._flow.written(write, inner, []) or ()]
        return [(value, chosen.bind(key, None)) for value, chosen in settled(found)]

    def _left_outside(self, unit: Unit, name: str, where: Expr, context: Context) -> Alternatives:
        """Return what the functions of a unit leave in a global variable."""
        found: Alternatives = []
        for function in unit.functions:
            if function in self._program.reached:
                here = [w for w in writes(unit, name, function.start, function.end) if w.owner is None]
                if here and not any(w.type is not None for w in here):
                    own = unit is where.unit and function is unit.function_at(where.at)
                    found += self._flow.back(here, where.at if own else function.end - 1, context)
        return found

    def _macro(self, unit: Unit, name: str, where: Expr, context: Context) -> Alternatives:
        body = Unit(unit.file, f"auto value = {unit.macros[name]};".encode())
        key = ("macro", unit, name)
        declarations = body.captured("global")
        value = declarations[0].child_by_field_name("declarator") if declarations else None
        node = value.child_by_field_name("value") if value is not None else None
        if node is None or context.get(key):
            return [(Unknown(f"the macro {name} is no expression"), context)]
        found = self._evaluator.values(Expr(where.unit, node, where.at), context.bind(key, True))
        return [(v, c.bind(key, None)) for v, c in found]


def _outside(unit: Unit, name: str) -> list[Write]:
    """Return the writes to a name that stand in no function."""
    return [w for w in writes(unit, name, 0, len(unit.source)) if unit.function_at(w.name.start_byte) is None]


def _through(found: Alternatives) -> Alternatives:
    return [(value.through_constant() if isinstance(value, Text) else value, context) for value, context in found]
