"""The evaluator: it walks an expression of Python over values of which some need not be known, and runs nothing.

Sub-classes give what differs between the languages of launch files: names that the file does not bind, attributes and
calls of objects of their own, and whether an error of Python ends the evaluation.
"""

from __future__ import annotations

import ast
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, ClassVar

from kg.extract.launch.expressions.containers import Containers
from kg.extract.launch.expressions.formatting import formatted
from kg.extract.launch.expressions.joining import concatenate
from kg.extract.launch.expressions.operators import binary, compare, truth, unary
from kg.extract.launch.expressions.texts import known, reason_of, written
from kg.extract.launch.expressions.values import (
    Choice,
    Condition,
    Frame,
    Function,
    Guarded,
    Library,
    Scope,
    Table,
    Unknown,
)
from kg.extract.launch.expressions.whole import MAX_BITS, ExpressionError, UnsupportedError, encodable, is_whole

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from kg.extract.launch.expressions.values import Value

__all__ = ["Evaluator"]


class Evaluator(Containers, ABC):
    """Evaluates expressions."""

    @abstractmethod
    def unbound(self, name: str) -> Value:
        """Return what a name means that nothing in the file binds."""

    @abstractmethod
    def attribute(self, receiver: Value, name: str) -> Value:
        """Return an attribute of a value."""

    @abstractmethod
    def invoke(
        self, function: Value, args: Sequence[Value], kwargs: Mapping[str, Value], node: ast.expr, frame: Frame
    ) -> Value:
        """Return what a call gives; `node` is where it stands."""

    def failed(self, error: ExpressionError | UnsupportedError) -> Value:
        """Return the value of an expression that Python cannot evaluate, or that is not evaluated here."""
        return Unknown(str(error))

    def evaluate(self, node: ast.expr, frame: Frame) -> Value:
        """Return the value of an expression; `Unknown` for what is not understood."""
        self.step()
        evaluator = self._evaluators.get(type(node))
        if evaluator is None:
            return self.failed(UnsupportedError(f"`{written(node)}` is not understood"))
        try:
            return evaluator(self, node, frame)
        except (ExpressionError, UnsupportedError) as error:
            return self.failed(error)

    def assign(self, target: ast.expr, value: Value, frame: Frame) -> None:
        """Bind the target of an assignment or loop: a name, or several."""
        if isinstance(target, ast.Name):
            frame.scope.bind(target.id, value)
        elif isinstance(target, ast.Starred):
            self.assign(target.value, value, frame)
        elif isinstance(target, ast.Tuple | ast.List):
            self._unpack(target.elts, value, frame)

    def _unpack(self, targets: list[ast.expr], value: Value, frame: Frame) -> None:
        found = self.iterate(value)
        star = next((number for number, each in enumerate(targets) if isinstance(each, ast.Starred)), None)
        if found is not None and star is not None and len(found) >= len(targets) - 1:
            tail = len(targets) - star - 1
            middle = self.items(found[star : len(found) - tail])
            found = [*found[:star], middle, *found[len(found) - tail :]]
        if found is None or len(found) != len(targets):
            if is_whole(value):
                error = ExpressionError(f"ValueError: {len(targets)} names for the values of `{type(value).__name__}`")
                self.failed(error)
            found = [Unknown(reason_of(value))] * len(targets)
        for target, item in zip(targets, found, strict=True):
            self.assign(target, item, frame)

    def _constant(self, node: ast.Constant, _: Frame) -> Value:
        if isinstance(node.value, bytes | complex) or node.value is ...:
            raise UnsupportedError(f"a literal of the type {type(node.value).__name__} is not evaluated")
        if isinstance(node.value, int) and node.value.bit_length() > MAX_BITS:
            raise UnsupportedError("a number grows too large")
        return encodable(node.value) if isinstance(node.value, str) else node.value

    def _name(self, node: ast.Name, frame: Frame) -> Value:
        """Return what a name is bound to, here or around."""
        scope = frame.scope.find(node.id)
        return scope.names[node.id] if scope is not None else self.unbound(node.id)

    def _binary(self, node: ast.BinOp, frame: Frame) -> Value:
        left, right = self.evaluate(node.left, frame), self.evaluate(node.right, frame)
        return self.weigh(binary(type(node.op), left, right))

    def _either(self, node: ast.BoolOp, frame: Frame) -> Value:
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

    def _unary(self, node: ast.UnaryOp, frame: Frame) -> Value:
        return unary(type(node.op), self.evaluate(node.operand, frame), self.context)

    def _comparison(self, node: ast.Compare, frame: Frame) -> Value:
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

    def _conditional(self, node: ast.IfExp, frame: Frame) -> Value:
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

    def _joined(self, node: ast.JoinedStr, frame: Frame) -> Value:
        """Return an f-string."""
        result: Value = ""
        for part in node.values:
            if not isinstance(part, ast.FormattedValue):
                result = concatenate(result, self.evaluate(part, frame))
                continue
            value = self.evaluate(part.value, frame)
            spec = known(self._joined(part.format_spec, frame)) if isinstance(part.format_spec, ast.JoinedStr) else ""
            result = concatenate(result, formatted(value, spec, chr(part.conversion) if part.conversion > 0 else ""))
        return self.weigh(result)

    def _member(self, node: ast.Attribute, frame: Frame) -> Value:
        return self.attribute(self.evaluate(node.value, frame), node.attr)

    def _call(self, node: ast.Call, frame: Frame) -> Value:
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
                reason = f"what `**{written(keyword.value)}` spreads: {reason_of(value)}"
                self.unresolved(reason, self.location(node, frame))
        return self.invoke(function, args, kwargs, node, frame)

    def _function(self, node: ast.Lambda, frame: Frame) -> Value:
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

    def _walrus(self, node: ast.NamedExpr, frame: Frame) -> Value:
        value = self.evaluate(node.value, frame)
        frame.scope.bind(node.target.id, value)
        return value

    def _subscript(self, node: ast.Subscript, frame: Frame) -> Value:
        receiver = self.evaluate(node.value, frame)
        if isinstance(node.slice, ast.Slice):
            ends = (node.slice.lower, node.slice.upper, node.slice.step)
            return self.cut(receiver, [self.evaluate(end, frame) if end else None for end in ends])
        return self.item(receiver, self.evaluate(node.slice, frame), written(node))

    def _sequence(self, node: ast.List | ast.Tuple | ast.Set, frame: Frame) -> Value:
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
        made = self.items(found) if isinstance(node, ast.List) else self.distinct(found)
        if len(node.elts) == len(made):
            made.places = tuple(self.location(element, frame) for element in node.elts)
        return made

    def _mapping(self, node: ast.Dict, frame: Frame) -> Value:
        """Return a dictionary, each entry with its place."""
        table = self.table()
        for key_node, value_node in zip(node.keys, node.values, strict=True):
            if key_node is None:
                self.spread_table(table, self.evaluate(value_node, frame))
                continue
            key = self.evaluate(key_node, frame)
            self.put(table, key, self.evaluate(value_node, frame), self.location(key_node, frame))
        return table

    def _comprehension(self, node: ast.ListComp | ast.SetComp | ast.GeneratorExp, frame: Frame) -> Value:
        """Return the list that a comprehension makes."""
        found = self.items()
        self.generate(node.generators, frame, lambda: self.append(found, [self.evaluate(node.elt, frame)]))
        return self.distinct(found) if isinstance(node, ast.SetComp) else found

    def _table_comprehension(self, node: ast.DictComp, frame: Frame) -> Value:
        """Return the dictionary that a comprehension makes."""
        table = self.table()

        def each() -> None:
            key, value = self.evaluate(node.key, frame), self.evaluate(node.value, frame)
            self.put(table, key, value, self.location(node.key, frame))

        unsure = self.generate(node.generators, frame, each)
        if unsure:
            table.rest = Unknown(unsure)
        return table

    def generate(self, clauses: Sequence[ast.comprehension], frame: Frame, each: Callable[[], None]) -> str | None:
        """Run the clauses of a comprehension; return why not all of its items are known, None where they are."""
        outer = frame.scope
        frame.scope = Scope(parent=outer)
        try:
            return self._clause(list(clauses), frame, each)
        finally:
            frame.scope = outer

    def _clause(self, clauses: list[ast.comprehension], frame: Frame, each: Callable[[], None]) -> str | None:
        if not clauses:
            each()
            return None
        clause, *rest = clauses
        iterated = self.evaluate(clause.iter, frame)
        items = self.iterate(iterated)
        if items is None and is_whole(iterated):
            self.failed(ExpressionError(f"TypeError: '{type(iterated).__name__}' object is not iterable"))
        unsure = reason_of(iterated) if items is None else None
        if items is None:  # one item stands for all, under a condition
            words_of = f"for {written(clause.target)} in {written(clause.iter)}"
            items = [Guarded(Condition(None, written=words_of), Unknown(reason_of(iterated)))]
        for item in items:
            self.step()
            height = len(self.guards)
            if isinstance(item, Guarded):
                self.guards.append(item.condition)
            self.assign(clause.target, item.value if isinstance(item, Guarded) else item, frame)
            if self._holds(clause.ifs, frame):
                unsure = self._clause(rest, frame, each) or unsure
            del self.guards[height:]
        return unsure

    def _holds(self, tests: Sequence[ast.expr], frame: Frame) -> bool:
        """Tell whether tests may hold; one that is not known becomes a condition."""
        for test in tests:
            found = truth(self.evaluate(test, frame), self.context)
            if found is False:
                return False
            if found is None:
                self.guards.append(Condition(None, written=written(test)))
        return True

    def builtin(self, name: str) -> Library:
        """Return a function of Python itself."""
        return Library(f"builtins.{name}")

    _evaluators: ClassVar[dict[type[ast.expr], Callable[..., Value]]] = {
        ast.Constant: _constant,
        ast.Name: _name,
        ast.BinOp: _binary,
        ast.BoolOp: _either,
        ast.UnaryOp: _unary,
        ast.Compare: _comparison,
        ast.IfExp: _conditional,
        ast.JoinedStr: _joined,
        ast.Attribute: _member,
        ast.Call: _call,
        ast.Lambda: _function,
        ast.NamedExpr: _walrus,
        ast.Subscript: _subscript,
        ast.List: _sequence,
        ast.Tuple: _sequence,
        ast.Set: _sequence,
        ast.Dict: _mapping,
        ast.ListComp: _comprehension,
        ast.SetComp: _comprehension,
        ast.GeneratorExp: _comprehension,
        ast.DictComp: _table_comprehension,
    }
