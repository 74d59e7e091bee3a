"""Evaluating expressions."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.actions import Condition
from kg.extract.launch.ros2.python.builtin import BUILTINS
from kg.extract.launch.ros2.python.containers import Containers
from kg.extract.launch.ros2.python.formatting import format_percent, formatted
from kg.extract.launch.ros2.python.machine import written
from kg.extract.launch.ros2.python.operators import add, binary, compare, truth
from kg.extract.launch.ros2.python.texts import known, reason_of
from kg.extract.launch.ros2.python.values import Choice, Function, Library, Table, Unknown

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.launch.ros2.python.machine import Frame
    from kg.extract.launch.ros2.python.values import Value

__all__ = ["Expressions"]


class Expressions(Containers):
    """The part of the interpreter that evaluates expressions."""

    def evaluate(self, node: ast.expr, frame: Frame) -> Value:
        """Return the value of an expression; `Unknown` for what is not understood."""
        self.step()
        evaluator = _EVALUATORS.get(type(node))
        return evaluator(self, node, frame) if evaluator else Unknown(f"`{written(node)}` is not understood")

    def constant(self, node: ast.Constant, _: Frame) -> Value:
        """Return a literal."""
        return node.value if not isinstance(node.value, bytes | complex) else Unknown("a literal of bytes")

    def name(self, node: ast.Name, frame: Frame) -> Value:
        """Return what a name is bound to, here or around."""
        scope = frame.scope.find(node.id)
        if scope is not None:
            return scope.names[node.id]
        if node.id in BUILTINS:
            return Library(f"builtins.{node.id}")
        return Unknown(f"the name `{node.id}` is not bound to anything known")

    def binary_operation(self, node: ast.BinOp, frame: Frame) -> Value:
        """Return `left OPERATOR right`."""
        left, right = self.evaluate(node.left, frame), self.evaluate(node.right, frame)
        if isinstance(node.op, ast.Mod) and isinstance(left, str):
            return format_percent(left, right)
        return self.weigh(binary(type(node.op), left, right))

    def either(self, node: ast.BoolOp, frame: Frame) -> Value:
        """Return `a and b`, `a or b`."""
        ends_at = isinstance(node.op, ast.Or)
        value: Value = None
        unsure: Value = None
        for operand in node.values:
            value = self.evaluate(operand, frame)
            found = truth(value, self.context)
            if found is None:
                unsure = Unknown(f"it depends on `{written(operand)}`")
            elif found is ends_at:
                return value if unsure is None or isinstance(value, bool) else unsure
        return value if unsure is None else unsure

    def unary(self, node: ast.UnaryOp, frame: Frame) -> Value:
        """Return `not a`, `-a`, `+a`."""
        value = self.evaluate(node.operand, frame)
        if isinstance(node.op, ast.Not):
            found = truth(value, self.context)
            return Unknown(reason_of(value)) if found is None else not found
        if isinstance(value, int | float):
            return -value if isinstance(node.op, ast.USub) else value
        return Unknown(reason_of(value))

    def comparison(self, node: ast.Compare, frame: Frame) -> Value:
        """Return whether a chain of comparisons holds."""
        left = self.evaluate(node.left, frame)
        result: bool | None = True
        for kind, operand in zip(node.ops, node.comparators, strict=True):
            right = self.evaluate(operand, frame)
            found = compare(type(kind), left, right, self.context)
            if found is False:
                return False
            result = None if found is None else result
            left = right
        return Unknown(f"it depends on `{written(node)}`") if result is None else True

    def conditional(self, node: ast.IfExp, frame: Frame) -> Value:
        """Return `a if c else b`."""
        found = truth(self.evaluate(node.test, frame), self.context)
        if found is not None:
            return self.evaluate(node.body if found else node.orelse, frame)
        words = written(node.test)
        return Choice(
            (
                (Condition(None, written=words), self.evaluate(node.body, frame)),
                (Condition(None, negated=True, written=words), self.evaluate(node.orelse, frame)),
            )
        )

    def joined(self, node: ast.JoinedStr, frame: Frame) -> Value:
        """Return an f-string."""
        result: Value = ""
        for part in node.values:
            if not isinstance(part, ast.FormattedValue):
                result = add(result, self.evaluate(part, frame))
                continue
            spec = known(self.joined(part.format_spec, frame)) if isinstance(part.format_spec, ast.JoinedStr) else ""
            value = self.evaluate(part.value, frame)
            result = add(result, formatted(value, spec, chr(part.conversion) if part.conversion > 0 else ""))
        return result

    def member(self, node: ast.Attribute, frame: Frame) -> Value:
        """Return `a.b`."""
        return self.attribute(self.evaluate(node.value, frame), node.attr)

    def call(self, node: ast.Call, frame: Frame) -> Value:
        """Return what a call gives."""
        function = self.evaluate(node.func, frame)
        args: list[Value] = []
        for argument in node.args:
            if isinstance(argument, ast.Starred):
                spread = self.iterate(self.evaluate(argument.value, frame))
                args += spread if spread is not None else [Unknown(f"what `*{written(argument.value)}` spreads")]
            else:
                args.append(self.evaluate(argument, frame))
        kwargs: dict[str, Value] = {}
        for keyword in node.keywords:
            value = self.evaluate(keyword.value, frame)
            if keyword.arg is not None:
                kwargs[keyword.arg] = value
            elif isinstance(value, Table):
                kwargs.update({key: item for key, item in value.items() if isinstance(key, str)})
            else:
                self.unresolved(
                    f"what `**{written(keyword.value)}` spreads: {reason_of(value)}", self.location(node, frame)
                )
        return self.invoke(function, args, kwargs, node, frame)

    def function(self, node: ast.Lambda, frame: Frame) -> Value:
        """Return a lambda."""
        return Function(node, frame.module, frame.scope, "<lambda>", self.defaults(node.args, frame))

    def defaults(self, parameters: ast.arguments, frame: Frame) -> dict[str, Value]:
        """Return the default values of a function's parameters, as they are when it is defined."""
        positional = [*parameters.posonlyargs, *parameters.args]
        tail = positional[len(positional) - len(parameters.defaults) :]
        found = {
            argument.arg: self.evaluate(value, frame) for argument, value in zip(tail, parameters.defaults, strict=True)
        }
        for argument, default in zip(parameters.kwonlyargs, parameters.kw_defaults, strict=True):
            if default is not None:
                found[argument.arg] = self.evaluate(default, frame)
        return found

    def walrus(self, node: ast.NamedExpr, frame: Frame) -> Value:
        """Return `(name := value)`."""
        value = self.evaluate(node.value, frame)
        frame.scope.bind(node.target.id, value)
        return value

    def subscript(self, node: ast.Subscript, frame: Frame) -> Value:
        """Return `a[b]`."""
        receiver = self.evaluate(node.value, frame)
        if isinstance(node.slice, ast.Slice):
            bounds = [
                self.evaluate(bound, frame) if bound else None
                for bound in (node.slice.lower, node.slice.upper, node.slice.step)
            ]
            return self.cut(receiver, bounds)
        return self.item(receiver, self.evaluate(node.slice, frame), written(node))

    def sequence(self, node: ast.List | ast.Tuple | ast.Set, frame: Frame) -> Value:
        """Return a list, tuple or set."""
        found: list[Value] = []
        for element in node.elts:
            starred = isinstance(element, ast.Starred)
            value = self.evaluate(element.value if isinstance(element, ast.Starred) else element, frame)
            if isinstance(value, Unknown) and value.place is None:
                value = Unknown(value.reason, self.location(element, frame))
            spread = self.iterate(value) if starred else None
            found += spread if spread is not None else [value]
        if isinstance(node, ast.Tuple):
            return tuple(found)
        made = self.items(found)
        if len(node.elts) == len(found):
            made.places = tuple(self.location(element, frame) for element in node.elts)
        return made

    def mapping(self, node: ast.Dict, frame: Frame) -> Value:
        """Return a dictionary, each entry with its place."""
        table = self.table()
        for key_node, value_node in zip(node.keys, node.values, strict=True):
            value = self.evaluate(value_node, frame)
            if key_node is None:
                self.spread_table(table, value)
                continue
            self.put(table, self.evaluate(key_node, frame), value, self.location(key_node, frame))
        return table

    def comprehension(self, node: ast.ListComp | ast.SetComp | ast.GeneratorExp, frame: Frame) -> Value:
        """Return the list that a comprehension makes."""
        found = self.items()
        self.generate(node.generators, frame, lambda: self.append(found, [self.evaluate(node.elt, frame)]))
        return found

    def table_comprehension(self, node: ast.DictComp, frame: Frame) -> Value:
        """Return the dictionary that a comprehension makes."""
        table = self.table()

        def each() -> None:
            key, value = self.evaluate(node.key, frame), self.evaluate(node.value, frame)
            self.put(table, key, value, self.location(node.key, frame))

        unsure = self.generate(node.generators, frame, each)
        if unsure:
            table.rest = Unknown(unsure)
        return table


_EVALUATORS: Final[dict[type[ast.expr], Callable[..., Value]]] = {
    ast.Constant: Expressions.constant,
    ast.Name: Expressions.name,
    ast.BinOp: Expressions.binary_operation,
    ast.BoolOp: Expressions.either,
    ast.UnaryOp: Expressions.unary,
    ast.Compare: Expressions.comparison,
    ast.IfExp: Expressions.conditional,
    ast.JoinedStr: Expressions.joined,
    ast.Attribute: Expressions.member,
    ast.Call: Expressions.call,
    ast.Lambda: Expressions.function,
    ast.NamedExpr: Expressions.walrus,
    ast.Subscript: Expressions.subscript,
    ast.List: Expressions.sequence,
    ast.Tuple: Expressions.sequence,
    ast.Set: Expressions.sequence,
    ast.Dict: Expressions.mapping,
    ast.ListComp: Expressions.comprehension,
    ast.SetComp: Expressions.comprehension,
    ast.GeneratorExp: Expressions.comprehension,
    ast.DictComp: Expressions.table_comprehension,
}
