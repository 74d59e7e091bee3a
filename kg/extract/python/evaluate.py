"""Evaluating expressions: every expression gives a few alternatives, each with the choices it rests on.

Evaluation is on demand and backwards: from the argument of an interface call to the bindings, calls and
attributes that give it its value. Depth, number of alternatives and work are bounded; beyond a bound a value
is unknown.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.python import formatting
from kg.extract.python.core import COMPUTED
from kg.extract.python.entities import Dotted, Items, Nothing, Table, Thunk, plain
from kg.extract.python.invoke import Invocations
from kg.extract.python.syntax import code, strip_parentheses
from kg.extract.values import Number, Text, Truth, Unknown, concatenate

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from tree_sitter import Node

    from kg.extract.python.entities import Alternatives, Choice, Frame, Thing

__all__ = ["Evaluator"]

_TOO_DEEP: Final = Unknown("it is computed in too many steps")
_CIRCULAR: Final = Unknown("it depends on itself")
_MAX_DEPTH: Final = 80
MAX_ALTERNATIVES: Final = 32
_MANY: Final = 8
"""From this many alternatives on, those of one value are one, whatever choices they rest on."""


class Evaluator(Invocations):
    """Evaluates expressions of a program; see `kg.extract.python.lookup` and `.invoke` for names and calls."""

    def evaluate(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """Return what an expression can be in a frame, given what was chosen so far; never an empty list."""
        handler = _HANDLERS.get(node.type)
        if handler is None:
            return [(COMPUTED, choice)]
        if node.type in _CHEAP:
            return handler(self, node, frame, choice)
        key = (node.id, frame.id)
        self.steps += 1
        if key in self.active or len(self.active) >= _MAX_DEPTH or self.steps > self.limit:
            self.cuts += 1
            return [(_CIRCULAR if key in self.active else _TOO_DEEP, choice)]
        known = (key, frozenset(choice.items()))
        if known not in self.memory:
            cuts = self.cuts
            self.active.add(key)
            found = _distinct(handler(self, node, frame, choice)) or [(COMPUTED, choice)]
            self.active.discard(key)
            if cuts != self.cuts and self.active:
                return found
            self.memory[known] = found
        return self.memory[known]

    def thunk(self, thunk: Thunk, choice: Choice) -> Alternatives:
        """Return what an argument can be."""
        if thunk.node is None or thunk.frame is None:
            return [(thunk.value or COMPUTED, choice)]
        return self.evaluate(thunk.node, thunk.frame, choice)

    def combined(
        self, thunks: Iterable[Thunk | Node], frame: Frame, choice: Choice
    ) -> list[tuple[list[Thing], Choice]]:
        """Return the combinations of the alternatives of several expressions that agree in their choices."""
        rows: list[tuple[list[Thing], Choice]] = [([], choice)]
        for item in thunks:
            thunk = item if isinstance(item, Thunk) else Thunk(item, frame)
            rows = [([*values, value], after) for values, before in rows for value, after in self.thunk(thunk, before)][
                :MAX_ALTERNATIVES
            ]
        return rows

    def string(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """A string literal or f-string."""
        prefix = code(node.named_children[0])
        if prefix.startswith("`"):
            return [(COMPUTED, choice)]
        if node.named_child_count == 2:  # noqa: PLR2004 - an empty string has a start and an end only
            return [(Text.of(""), choice)]
        inner = node.named_children[1:-1]
        fields = [child for child in inner if child.type == "interpolation"]
        rows = self.combined((_interpolated(field) for field in fields), frame, choice)
        return [(_assemble(prefix, inner, values), after) for values, after in rows]

    def concatenated(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """String literals in a row."""
        parts = [child for child in node.named_children if child.type == "string"]
        rows = self.combined(parts, frame, choice)
        return [(concatenate(*map(formatting.stringify, values)), after) for values, after in rows]

    def integer(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """A number."""
        del frame
        written = code(node)
        try:
            value = float(written) if node.type == "float" else int(written.rstrip("lL"), 0)
        except ValueError:
            return [(COMPUTED, choice)]
        return [(Number(value, written), choice)]

    def truth_literal(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """`True` or `False`."""
        del frame
        return [(Truth(node.type == "true"), choice)]

    def nothing(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """`None`."""
        del node, frame
        return [(Nothing(), choice)]

    def inside(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """An expression in parentheses, awaited or yielded."""
        inner = strip_parentheses(node)
        if inner is node:
            inner = node.named_children[0]
        return self.evaluate(inner, frame, choice)

    def identifier(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """A name."""
        return self.name(code(node), node.start_byte, frame, choice)

    def attribute(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """`value.name`."""
        held, name = node.child_by_field_name("object"), code(node.child_by_field_name("attribute"))
        if held is None:
            return [(COMPUTED, choice)]
        local = self.assigned_here(node, frame, choice)
        if local is not None:
            return local
        found: Alternatives = []
        for value, after in self.evaluate(held, frame, choice):
            found.extend(self.member(value, name, frame, after))
        return found

    def items(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """A list, tuple or set."""
        parts = [child for child in node.named_children if child.type != "comment"]
        return [(Items(tuple(values)), after) for values, after in self.combined(parts, frame, choice)]

    def table(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """A dictionary."""
        pairs = [child for child in node.named_children if child.type == "pair"]
        sides = [side for pair in pairs for side in pair.named_children[:2]]
        rows = self.combined(sides, frame, choice)
        return [(Table(tuple(zip(values[::2], values[1::2], strict=True))), after) for values, after in rows]

    def comprehension(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """A list made by a comprehension with one `for` and no condition."""
        clauses = [child for child in node.named_children if child.type in ("for_in_clause", "if_clause")]
        if len(clauses) != 1:
            return [(COMPUTED, choice)]
        body, key = node.named_children[0], (frame.id, clauses[0].start_byte)
        right = clauses[0].child_by_field_name("right")
        found: Alternatives = []
        for value, after in self.evaluate(right, frame, choice) if right is not None else ():
            rounds = self.rounds(value)
            if rounds is None:
                found.append((COMPUTED, after))
                continue
            made = [self.evaluate(body, frame, {**after, key: index})[0][0] for index in range(len(rounds))]
            found.append((Items(tuple(made)), after))
        return found

    def subscript(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """`value[key]`."""
        held, key = node.child_by_field_name("value"), node.child_by_field_name("subscript")
        if held is None or key is None:
            return [(COMPUTED, choice)]
        found: Alternatives = []
        for (value, index), after in ((row, after) for row, after in self.combined((held, key), frame, choice)):
            found.extend(self.item(value, index, node, frame, after))
        return found

    def binary(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """`+`, `%` and the like; long sums are taken apart without recursion."""
        operands, operators = [], []
        while node.type == "binary_operator":
            left, right = node.child_by_field_name("left"), node.child_by_field_name("right")
            if left is None or right is None:
                return [(COMPUTED, choice)]
            operands.append(right)
            operators.append(code(node.child_by_field_name("operator")))
            node = left
        rows = self.combined(reversed([*operands, node]), frame, choice)
        return [(_fold(values, operators[::-1]), after) for values, after in rows]

    def boolean(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """`a or b` gives both unless the first is known to decide; `a and b` gives the second."""
        left, right = node.child_by_field_name("left"), node.child_by_field_name("right")
        if left is None or right is None:
            return [(COMPUTED, choice)]
        if code(node.child_by_field_name("operator")) == "and":
            return self.evaluate(right, frame, choice)
        found: Alternatives = []
        for value, after in self.evaluate(left, frame, choice):
            known = plain(value)
            if known or (known is None and not isinstance(value, Nothing | Unknown)):
                found.append((value, after))
            if not known:
                found.extend(self.evaluate(right, frame, after))
        return found

    def conditional(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """`a if condition else b`."""
        yes, condition, no = node.named_children[:3]
        decided = self.decide(condition, frame, choice)
        key = (frame.id, node.start_byte)
        found: Alternatives = []
        for number, branch, excluded in ((0, yes, False), (1, no, True)):
            if decided is not excluded and choice.get(key, number) == number:
                found.extend(self.evaluate(branch, frame, {**choice, key: number}))
        return found

    def comparison(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """A comparison, known where `decide` knows it."""
        decided = self.decide(node, frame, choice)
        return [(Truth(decided) if decided is not None else COMPUTED, choice)]

    def negative(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """`-number`."""
        inner = node.child_by_field_name("argument")
        values = self.evaluate(inner, frame, choice) if inner is not None else []
        return [
            (Number(-value.value, f"-{value.written}"), after) if isinstance(value, Number) else (COMPUTED, after)
            for value, after in values
        ]


def _interpolated(field: Node) -> Node:
    return field.child_by_field_name("expression") or field.named_children[0]


def _specification(field: Node) -> str:
    """Return the format specification of a field of an f-string; one that holds fields itself has a brace in it."""
    return next((code(child)[1:] for child in field.named_children if child.type == "format_specifier"), "")


def _assemble(prefix: str, inner: list[Node], values: list[Thing]) -> Text:
    pieces, rest = [], iter(values)
    for child in inner:
        if child.type == "interpolation":
            pieces.append(formatting.formatted(next(rest), _specification(child)))
        elif child.type == "string_content":
            body = formatting.decode_literal(prefix, code(child))
            pieces.append(Text.of(body.replace("{{", "{").replace("}}", "}") if "f" in prefix.lower() else body))
    return concatenate(*pieces)


def _fold(values: list[Thing], operators: list[str]) -> Thing:
    result = values[0]
    for operator, value in zip(operators, values[1:], strict=True):
        result = _operate(result, operator, value)
    return result


def _operate(left: Thing, operator: str, right: Thing) -> Thing:
    if operator == "%" and isinstance(left, Text):
        return formatting.format_percent(left, right)
    if operator == "/" and isinstance(left, Dotted | Text):
        return COMPUTED
    if operator != "+":
        return COMPUTED
    if isinstance(left, Items) and isinstance(right, Items):
        return Items(left.items + right.items)
    if isinstance(left, Number) and isinstance(right, Number):
        total = left.value + right.value
        return Number(total, str(total))
    if isinstance(left, Text) or isinstance(right, Text):
        return concatenate(formatting.stringify(left), formatting.stringify(right))
    return COMPUTED


def _distinct(found: Alternatives) -> Alternatives:
    """Return the alternatives without repetitions, one unknown at most, and not too many."""
    kept: Alternatives = []
    unknown = False
    if len(found) <= 1:
        return found
    for item in found:
        if isinstance(item[0], Unknown):
            unknown, again = True, unknown
            if again:
                continue
        if item not in kept and (len(kept) < _MANY or all(item[0] != other for other, _ in kept)):
            kept.append(item)
        if len(kept) >= MAX_ALTERNATIVES:
            break
    return kept


_CHEAP: Final = frozenset({"integer", "float", "true", "false", "none", "not_operator"})
"""Kinds of expressions that cost no more to evaluate than to remember."""

_HANDLERS: Final[dict[str, Callable[[Evaluator, Node, Frame, Choice], Alternatives]]] = {
    "string": Evaluator.string,
    "concatenated_string": Evaluator.concatenated,
    "integer": Evaluator.integer,
    "float": Evaluator.integer,
    "true": Evaluator.truth_literal,
    "false": Evaluator.truth_literal,
    "none": Evaluator.nothing,
    "parenthesized_expression": Evaluator.inside,
    "await": Evaluator.inside,
    "identifier": Evaluator.identifier,
    "attribute": Evaluator.attribute,
    "list": Evaluator.items,
    "tuple": Evaluator.items,
    "set": Evaluator.items,
    "expression_list": Evaluator.items,
    "dictionary": Evaluator.table,
    "list_comprehension": Evaluator.comprehension,
    "generator_expression": Evaluator.comprehension,
    "subscript": Evaluator.subscript,
    "binary_operator": Evaluator.binary,
    "boolean_operator": Evaluator.boolean,
    "conditional_expression": Evaluator.conditional,
    "comparison_operator": Evaluator.comparison,
    "not_operator": Evaluator.comparison,
    "unary_operator": Evaluator.negative,
    "call": Evaluator.call,
}
