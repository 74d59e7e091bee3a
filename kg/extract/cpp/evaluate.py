"""The evaluator: what an expression can be at run time, found backwards from where it stands.

`Evaluator.values` returns alternatives, each with the choices that lead to it (`kg.extract.cpp.context`).
Names are followed by `kg.extract.cpp.flow`, calls of libraries by `kg.extract.cpp.library`, calls that read
parameters or make node handles by the tables of `kg.extract.cpp.api`. What is not understood becomes
`Unknown` with a reason; a write that is not found is missing from the alternatives. Depth, number of
alternatives and number of steps are bounded.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from tree_sitter import Query

from kg.extract.cpp import library, syntax
from kg.extract.cpp.constants import Constants
from kg.extract.cpp.context import Context, Memory, Site
from kg.extract.cpp.flow import Flow
from kg.extract.cpp.sites import Sites, call_around, fits
from kg.extract.cpp.types import Types
from kg.extract.cpp.unit import Expr
from kg.extract.cpp.variables import writes
from kg.extract.values import Handle, Sequence, Text, Truth, Unknown, Value, concatenate

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterable, Iterator

    from tree_sitter import Node

    from kg.extract.cpp.api import Api
    from kg.extract.cpp.program import Program
    from kg.extract.cpp.types import TypeName
    from kg.extract.cpp.unit import Function, Unit

__all__ = ["Alternatives", "Evaluator"]

Alternatives = list[tuple[Value, Context]]

_MOST: Final = 64
_DEEPEST: Final = 48
_STEPS: Final = 1500
_RETURNS: Final = Query(syntax.LANGUAGE, "(return_statement) @return")


class Evaluator:
    """Evaluates expressions of one program."""

    def __init__(self, program: Program, api: Api) -> None:
        self.program = program
        self.api = api
        self.sites = Sites(program)
        self.types = Types(program, self.sites)
        self.flow = Flow(self)
        self.constants = Constants(self)
        self.memory = Memory()
        self._steps = 0
        self._cut = 0
        self._declared: dict[str, Expr] | None = None
        self._kinds: dict[str, Callable[[Expr, Context], Alternatives]] = {
            "identifier": self._name,
            "field_identifier": self._name,
            "type_identifier": self._name,
            "qualified_identifier": self._qualified,
            "field_expression": self._field,
            "call_expression": self._call,
            "binary_expression": self._binary,
            "conditional_expression": self._conditional,
            "concatenated_string": self._concatenated,
            "ERROR": self._literal_and_macro,
            "initializer_list": self._list,
            "compound_literal_expression": self._compound,
            "new_expression": self._compound,
            "subscript_expression": self._subscript,
            "assignment_expression": self._assignment,
            "this": self._this,
            "parameter_list": self._reparsed,
        }

    def restart(self) -> None:
        """Begin the budget of one interface."""
        self._steps = 0

    def values(self, where: Expr, context: Context) -> Alternatives:
        """Return what an expression can be; never empty."""
        self._steps += 1
        if context.depth > _DEEPEST or self._steps > _STEPS:
            self._cut += 1
            return [(Unknown("the code that makes it is too involved to follow"), context)]
        node = syntax.unwrap(where.node)
        simple = _literal(node)
        if simple is not None:
            return [(simple, context)]
        evaluate = self._kinds.get(node.type)
        if evaluate is None:
            return [(Unknown(f"it is computed at run time ({_shown(node)})"), context)]
        inner = where.child(node)
        moved = None if inner.at == node.start_byte else syntax.text(node)  # the node may be a macro's, of another tree
        key = (where.unit, node.start_byte, node.end_byte, inner.at, moved)
        return self.recalled(
            key,
            context,
            lambda: bounded([(v, c.at(context.depth)) for v, c in evaluate(inner, context.deeper())]),
        )

    def recalled(self, key: Hashable, context: Context, evaluate: Callable[[], Alternatives]) -> Alternatives:
        """Return what `evaluate` finds, from memory where the choices it depends on are the same as before."""
        return self.memory.recall(key, context, lambda: self._counted(evaluate))

    def _counted(self, evaluate: Callable[[], Alternatives]) -> tuple[Alternatives, bool]:
        """Return what is found, and whether no bound was met on the way."""
        cut = self._cut
        found = evaluate()
        return found, self._cut == cut

    def declared_default(self, parameter: str) -> Expr | None:
        """Return the default that a ROS 2 parameter is declared with, wherever the node declares it."""
        if self._declared is None:
            self._declared = {}
            for word in ("declare_parameter", *sorted(self.api.helpers)):
                for unit, node in self.program.sites(word):
                    self._note_default(unit, call_around(node))
        return self._declared.get(parameter)

    def _note_default(self, unit: Unit, call: Node | None) -> None:
        given = syntax.arguments(call.child_by_field_name("arguments")) if call is not None else []
        names = [syntax.literal(argument) for argument in given[:2]]
        for index, name in enumerate(names):
            if name is not None and index + 1 < len(given) and self._declared is not None:
                self._declared.setdefault(name, Expr.of(unit, given[index + 1]))
                return

    def texts(self, where: Expr, context: Context) -> list[tuple[Text | Unknown, Context]]:
        """Return the alternatives as texts; what is no text is an `Unknown`."""
        found: list[tuple[Text | Unknown, Context]] = []
        for value, chosen in self.values(where, context):
            if isinstance(value, Text | Unknown):
                found.append((value, chosen))
            else:
                found.append((Unknown(f"it is no text ({_shown(where.node)})"), chosen))
        return found

    def product(self, exprs: Iterable[Expr], context: Context) -> list[tuple[list[Value], Context]]:
        """Return the joint alternatives of several expressions, evaluated in order."""
        rows: list[tuple[list[Value], Context]] = [([], context)]
        for expr in exprs:
            rows = [([*row, value], after) for row, chosen in rows for value, after in self.values(expr, chosen)][
                :_MOST
            ]
        return rows

    def joined(self, exprs: Iterable[Expr], context: Context) -> Alternatives:
        """Return the concatenation of several expressions."""
        return [(concatenate(*row), chosen) for row, chosen in self.product(exprs, context)]

    def _name(self, where: Expr, context: Context) -> Alternatives:
        found = self.flow.name(syntax.text(where.node), where, context)
        return [(_through(value), chosen) for value, chosen in found]

    def _qualified(self, where: Expr, context: Context) -> Alternatives:
        scope, inner = syntax.split_scope(where.node)
        name = syntax.simple_name(inner)
        return self._trait(name, where, context) or self.constants.find(name, scope, where, context)

    def _trait(self, name: str, where: Expr, context: Context) -> Alternatives:
        """Return what `T::name` is for the classes that a template parameter `T` is bound to."""
        outer = where.node.child_by_field_name("scope")
        if outer is None or outer.type != "namespace_identifier":
            return []
        found: Alternatives = []
        for bound, chosen in self.types.parameter(syntax.text(outer), where, context):
            for kind, settled in self.types.settle(bound, chosen):
                cls = self.types.class_of(kind)
                default = cls.fields[name][1] if cls is not None and name in cls.fields else None
                if cls is not None and default is not None:
                    found += [(value, settled) for value, _ in self.values(Expr.of(cls.unit, default), settled)]
        return found

    def _field(self, where: Expr, context: Context) -> Alternatives:
        holder, field = where.node.child_by_field_name("argument"), where.node.child_by_field_name("field")
        if holder is None or field is None:
            return [(Unknown("the expression does not parse"), context)]
        name = syntax.simple_name(field)
        if holder.type == "this":
            return self.flow.name(name, where, context, member=True)
        if name in ("first", "second"):
            pairs = self.values(where.child(holder), context)
            index = 0 if name == "first" else 1
            found = [(v.items[index], c) for v, c in pairs if isinstance(v, Sequence) and len(v.items) > index]
            if found:
                return list(found)
        found = self.flow.field(name, where.child(holder), where, context)
        return [(_through(value), chosen) for value, chosen in found]

    def _call(self, where: Expr, context: Context) -> Alternatives:
        function = where.node.child_by_field_name("function")
        called = syntax.callee(function) if function is not None else None
        if called is None:
            return [(Unknown(f"it is computed at run time ({_shown(where.node)})"), context)]
        given = [where.child(a) for a in syntax.arguments(where.node.child_by_field_name("arguments"))]
        known = self.api.evaluate(self, where, called, given, context)
        if known is None and called.receiver is not None and self.program.functions(called.name):
            own = self.types.class_of(self.types.of(where.child(called.receiver), context)) is not None
            known = self._into(where, called, given, context) if own else None
        if known is None:
            known = library.evaluate(self, where, called, given, context)
        if known is None:
            known = self._lambda(where, called, given, context) or self._into(where, called, given, context)
        if known is None and called.receiver is None and not self.program.functions(called.name):
            kind = self.types.of(where, context)
            known = self.construct(kind, given, context) if kind is not None else None
        return known or [(Unknown(f"{called.name}() is not in the sources that were read"), context)]

    def _into(self, where: Expr, called: syntax.Callee, given: list[Expr], context: Context) -> Alternatives | None:
        """Return what functions of the program return when they are called like this."""
        site = Site(where, tuple(given), tuple(where.child(a) for a in syntax.arguments(called.template)), context)
        cls = self.types.class_of(self.types.of(where.child(called.receiver), context)) if called.receiver else None
        found: Alternatives = []
        for function in self.program.functions(called.name, where.unit):
            owner = self.program.owner(function)
            if cls is not None and owner is not None and owner not in self.program.family(cls):
                continue
            if fits(function, len(given)) and context.get(function) is None:
                inner = context.bind(function, site)
                for result in returned(function):
                    found += [(value, context) for value, _ in self.values(result, inner)]
        return found or None

    def _lambda(self, where: Expr, called: syntax.Callee, given: list[Expr], context: Context) -> Alternatives:
        """Return what a lambda of the same function returns when it is called like this."""
        unit, function = where.unit, where.unit.function_at(where.at)
        if function is None or called.receiver is not None or called.scope:
            return []
        found: Alternatives = []
        for write in writes(unit, called.name, function.start, function.end):
            if write.node.type == "lambda_expression" and write.name.start_byte < where.at:
                inner = context.bind(("lambda", unit, write.node.start_byte), Site(where, tuple(given)))
                for node in syntax.captures(_RETURNS, write.node).get("return", []):
                    if node.named_children and not _in_lambda(node, write.node):
                        result = Expr.of(unit, node.named_children[0])
                        found += [(value, context) for value, _ in self.values(result, inner)]
        return found

    def construct(self, kind: TypeName | None, given: list[Expr], context: Context) -> Alternatives | None:
        """Return what an object of a type made from arguments is; None if the type says nothing."""
        if kind is None:
            return self.values(given[0], context) if len(given) == 1 else None
        known = self.api.construct(self, kind, given, context)
        return known if known is not None else library.construct(self, kind, given, context)

    def _binary(self, where: Expr, context: Context) -> Alternatives:
        operator = where.node.child_by_field_name("operator")
        sign = syntax.text(operator) if operator is not None else ""
        operands = library.operands(where.node, sign)
        exprs = [where.child(operand) for operand in operands]
        if sign == "+":
            return [(library.add(row), chosen) for row, chosen in self.product(exprs, context)]
        if sign == "%" and (pattern := library.pattern(operands[0])) is not None:
            rows = self.product([where.child(pattern), *exprs[1:]], context)
            return [(library.formatted(row), chosen) for row, chosen in rows]
        if sign == "<<":
            return self.joined(exprs[1:], context)
        if sign in ("-", "*", "/"):
            return [(library.compute(sign, row), chosen) for row, chosen in self.product(exprs, context)]
        return [(Unknown("it depends on a comparison"), context)]

    def _conditional(self, where: Expr, context: Context) -> Alternatives:
        found: Alternatives = []
        for part in ("consequence", "alternative"):
            node = where.node.child_by_field_name(part)
            if node is not None:
                found += self.values(where.child(node), context)
        return found

    def _concatenated(self, where: Expr, context: Context) -> Alternatives:
        return self.joined([where.child(child) for child in syntax.arguments(where.node)], context)

    def _literal_and_macro(self, where: Expr, context: Context) -> Alternatives:
        """Return `"text" MACRO`, whose second part the grammar takes for an error."""
        literal = where.node.prev_named_sibling
        pieces = [literal, *where.node.named_children] if literal is not None else where.node.named_children
        return self.joined([where.child(piece) for piece in pieces], context)

    def _list(self, where: Expr, context: Context) -> Alternatives:
        rows = self.product([where.child(child) for child in syntax.arguments(where.node)], context)
        return [(Sequence(tuple(row)), chosen) for row, chosen in rows]

    def _reparsed(self, where: Expr, context: Context) -> Alternatives:
        given = [where.child(node) for node in where.unit.reparse(where.node)]
        return self.values(given[0], context) if len(given) == 1 else [(Unknown("it is constructed"), context)]

    def _compound(self, where: Expr, context: Context) -> Alternatives:
        kind = where.node.child_by_field_name("type")
        value = where.node.child_by_field_name("value") or where.node.child_by_field_name("arguments")
        given = [where.child(node) for node in syntax.arguments(value)]
        if kind is None:
            return [(Unknown("it has no type"), context)]
        found: Alternatives = []
        for settled, chosen in self.types.settle(where.child(kind), context):
            made = self.construct(settled, given, chosen)
            found += made if made is not None else [(Unknown(f"it is an object of {settled.qualified}"), chosen)]
        return found or [(Unknown("its type is not known"), context)]

    def _subscript(self, where: Expr, context: Context) -> Alternatives:
        holder, indices = where.node.child_by_field_name("argument"), where.node.child_by_field_name("indices")
        given = syntax.arguments(indices)
        if holder is None or len(given) != 1:
            return [(Unknown("the element is not known"), context)]
        return self.element(where.child(holder), where.child(given[0]), context)

    def element(self, container: Expr, index: Expr, context: Context) -> Alternatives:
        """Return what stands at an index of a container: that element, or each where the index is not known."""
        found: Alternatives = []
        for (held, key), chosen in ((row, c) for row, c in self.product([container, index], context)):
            choices = library.at(held, key)
            if len(choices) == 1:
                found.append((choices[0], chosen))
                continue
            point = ("element", index.unit, index.node.start_byte)
            taken = chosen.get(point)
            for number, value in enumerate(choices):
                if taken is None or taken == number:
                    found.append((value, chosen.bind(point, number)))
        return found or [(Unknown("the elements of the container are not known"), context)]

    def _assignment(self, where: Expr, context: Context) -> Alternatives:
        right = where.node.child_by_field_name("right")
        return self.values(where.child(right), context) if right is not None else [(Unknown("no value"), context)]

    def _this(self, where: Expr, context: Context) -> Alternatives:
        cls = self.types.class_around(where.unit, where.at)
        if cls is not None and self.api.is_node(self, cls):
            return [(Handle(), context)]
        return [(Unknown("it is an object, no text"), context)]


def returned(function: Function) -> Iterator[Expr]:
    """Yield the expressions that a function returns."""
    for node in syntax.captures(_RETURNS, function.node).get("return", []):
        if node.named_children and not _in_lambda(node, function.node):
            yield Expr.of(function.unit, node.named_children[0])


def _in_lambda(node: Node, end: Node) -> bool:
    for parent in syntax.outward(node):
        if parent.id == end.id:
            break
        if parent.type == "lambda_expression":
            return True
    return False


def bounded(found: Alternatives) -> Alternatives:
    """Return at most the bound of alternatives, each once, the rest as one that is not known."""
    seen: dict[tuple[Value, int], tuple[Value, Context]] = {}
    for value, context in found:
        seen.setdefault((value, id(context)), (value, context))
    kept = list(seen.values())
    if len(kept) > _MOST:
        kept = [*kept[:_MOST], (Unknown(f"there are more than {_MOST} possibilities"), kept[-1][1])]
    return kept


def _through(value: Value) -> Value:
    """Return a value as read from a variable."""
    if isinstance(value, Sequence):
        return Sequence(tuple(_through(item) for item in value.items))
    return value.through_constant() if isinstance(value, Text) else value


def _literal(node: Node) -> Value | None:
    string = syntax.literal(node)
    if string is not None:
        return Text.of(string)
    if node.type == "number_literal":
        return library.number(syntax.text(node))
    if node.type in ("true", "false"):
        return Truth(node.type == "true")
    if node.type in ("null", "nullptr"):
        return Unknown("it is a null pointer")
    return None


def _shown(node: Node) -> str:
    shown = " ".join(syntax.text(node).split())
    return shown if len(shown) < 60 else shown[:57] + "..."  # noqa: PLR2004 - a line's worth
