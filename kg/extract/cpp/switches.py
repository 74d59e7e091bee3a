"""Code that runs only when a boolean parameter says so: `if (publish_voxel_) voxel_pub_ = nh.advertise<...>(...);`."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Final

from kg.extract.cpp import syntax

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tree_sitter import Node

    from kg.extract.cpp.api import ParameterSpec
    from kg.extract.cpp.program import Program
    from kg.extract.cpp.unit import Expr
    from kg.facts import Parameter

__all__ = ["Switches"]

_NAMED: Final = frozenset({"identifier", "field_identifier", "field_expression"})
_INNER: Final = frozenset({"field_expression", "call_expression", "parenthesized_expression"})
_TRUTHS: Final = frozenset({"true", "false"})


class Switches:
    """The variables of a program that hold boolean parameters, and the branches on them.

    A variable counts where all that is written to it is one parameter.
    """

    def __init__(self, program: Program) -> None:
        self._program = program
        self._held: defaultdict[str, set[str]] = defaultdict(set)
        self._plain: dict[str, bool] = {}

    def note(self, spec: ParameterSpec, call: Node, given: list[Expr], parameter: Parameter) -> None:
        """Note where a call that reads a parameter puts the value."""
        if parameter.name is None or "{}" in parameter.name:
            return
        if parameter.type != "bool" and parameter.default not in _TRUTHS:
            return
        variable = None
        if spec.output is not None and spec.output < len(given):
            variable = _variable(given[spec.output].node)
        elif spec.returns:
            variable = _assigned(call)
        if variable is not None:
            self._held[variable].add(parameter.name)

    def around(self, node: Node) -> tuple[str, ...]:
        """Return the parameters that have to be true for the code at a node to run; those that must not with a `!`."""
        if not self._held:
            return ()
        found: dict[str, None] = {}
        inner = node
        for outer in syntax.outward(node):
            if outer.type == "if_statement":
                condition, other = outer.child_by_field_name("condition"), outer.child_by_field_name("alternative")
                if condition is not None and inner.id != condition.id:
                    held = other is None or inner.id != other.id
                    found.update(dict.fromkeys(self._asked(syntax.text(condition), held=held)))
            inner = outer
        return tuple(found)

    def _asked(self, condition: str, *, held: bool) -> Iterator[str]:
        """Yield what a condition asks of parameters where it holds, or does not."""
        words = condition.strip()
        if words.startswith("(") and words.endswith(")"):
            words = words[1:-1].strip()
        terms = [term.strip() for term in words.split("&&")]
        if "||" in words or (not held and len(terms) > 1):
            return
        for term in terms:
            negated = term.startswith("!")
            name = term.removeprefix("!").strip().removeprefix("this->")
            parameters = self._held.get(name, set())
            if len(parameters) == 1 and self._written_once(name):
                yield ("" if held != negated else "!") + next(iter(parameters))

    def _written_once(self, name: str) -> bool:
        """Tell whether nothing but constants and calls that were noted is assigned to a variable."""
        if name not in self._plain:
            places = (node for unit in self._program.units.values() for node in unit.occurrences(name))
            self._plain[name] = not any(_writes(node) for node in places)
        return self._plain[name]


def _variable(node: Node) -> str | None:
    return syntax.text(node).strip().removeprefix("this->") if node.type in _NAMED else None


def _assigned(call: Node) -> str | None:
    """Return the variable that gets the value of a call, or of what is asked of its value (`.as_bool()`)."""
    for outer in syntax.outward(call):
        if outer.type == "assignment_expression":
            left = outer.child_by_field_name("left")
            return _variable(left) if left is not None else None
        if outer.type == "init_declarator":
            declarator = outer.child_by_field_name("declarator")
            return _variable(declarator) if declarator is not None else None
        if outer.type not in _INNER:
            return None
    return None


def _writes(node: Node) -> bool:
    """Tell whether the variable at a node is assigned something that is neither constant nor a call."""
    target = node.parent if node.parent is not None and node.parent.type == "field_expression" else node
    outer = target.parent
    if outer is None or outer.type != "assignment_expression":
        return False
    left, right = outer.child_by_field_name("left"), outer.child_by_field_name("right")
    if left is None or right is None or left.id != target.id:
        return False
    return right.type not in _TRUTHS and right.type != "call_expression"
