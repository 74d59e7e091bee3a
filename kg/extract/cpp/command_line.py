"""Code that runs only when the command line has enough arguments: `if (argc == 3) node.play(argv[1], argv[2]);`."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from kg.extract.cpp import syntax

if TYPE_CHECKING:
    from tree_sitter import Node

    from kg.extract.cpp.program import Program
    from kg.extract.cpp.sites import Sites
    from kg.extract.cpp.unit import Function, Unit

__all__ = ["CommandLine"]

_COUNT: Final = re.compile(r"\bargc\s*(==|!=|>=|<=|>|<)\s*(\d+)")
_MOST_CALLS: Final = 4
"""How many calls deep a branch of `main` is looked for."""


class CommandLine:
    """How many arguments the code of a program needs; what is found for a function is kept."""

    def __init__(self, program: Program, sites: Sites) -> None:
        self._program = program
        self._sites = sites
        self._found: dict[tuple[Function, int], int] = {}

    def needed(self, unit: Unit, node: Node, depth: int = 0) -> int:
        """Return how many arguments the command line has, at least, when the code at a node runs."""
        here = _in_branches(node)
        function = unit.function_at(node.start_byte)
        if function is None or function.name == "main" or depth >= _MOST_CALLS or self._program.is_entry(function):
            return here
        return max(here, self._by_callers(function, depth))

    def _by_callers(self, function: Function, depth: int) -> int:
        key = (function, depth)
        if key not in self._found:
            fewest: int | None = None
            for site in self._sites.calls(function):
                needed = self.needed(site.where.unit, site.where.node, depth + 1)
                fewest = needed if fewest is None else min(fewest, needed)
                if fewest == 0:
                    break
            self._found[key] = fewest or 0
        return self._found[key]


def _in_branches(node: Node) -> int:
    """Return the arguments that the branches around a node ask for."""
    found, inner = 0, node
    for outer in syntax.outward(node):
        if outer.type == "if_statement":
            condition, other = outer.child_by_field_name("condition"), outer.child_by_field_name("alternative")
            if condition is not None and inner.id != condition.id and "argc" in syntax.text(condition):
                told = _COUNT.search(syntax.text(condition))
                held = other is None or inner.id != other.id
                if told is not None and (held or "&&" not in syntax.text(condition)):
                    found = max(found, _least(told[1], int(told[2]), held=held))
        inner = outer
    return found


def _least(sign: str, count: int, *, held: bool) -> int:
    """Return the fewest arguments with which a comparison of `argc` holds, or does not; the program itself is one."""
    if not held:
        sign = {"==": "!=", "!=": "==", ">=": "<", "<=": ">", ">": "<=", "<": ">="}[sign]
    if sign == "!=":
        return 1 if count == 1 else 0
    least = {"==": count, ">=": count, ">": count + 1}.get(sign, 1)
    return max(least - 1, 0)
