"""Running statements; where a condition cannot be known both branches are run, guarded by it."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, Final

from kg.extract.launch.expressions.operators import binary, same, truth
from kg.extract.launch.expressions.texts import known, reason_of, to_text, written
from kg.extract.launch.expressions.values import (
    Choice,
    Condition,
    Frame,
    Function,
    Guarded,
    Items,
    Library,
    Method,
    Scope,
    Table,
    Unknown,
)
from kg.extract.launch.expressions.whole import ExpressionError, UnsupportedError
from kg.extract.launch.ros2.python.machine import Break, Continue, Machine, Raised, Return
from kg.extract.launch.ros2.python.values import ContextValue, Instance, Klass, LoadedFile
from kg.facts import LaunchProblemKind

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kg.extract.launch.expressions.values import Value
    from kg.extract.launch.ros2.python.machine import Signal

__all__ = ["Statements"]

_MAX_ROUNDS: Final = 2_000
_TOO_LONG: Final = f"a loop is read for {_MAX_ROUNDS:,} rounds only"
_Outcome = tuple[Condition, "Signal", dict[str, "Value"]]


class Statements(Machine):
    """The part of the interpreter that runs statements."""

    def run_block(self, body: Sequence[ast.stmt], frame: Frame) -> Signal:
        """Run statements until one ends the block."""
        for statement in body:
            self.step()
            runner = _RUNNERS.get(type(statement))
            signal = runner(self, statement, frame) if runner else None
            if signal is not None:
                return signal
        return None

    def run_expression(self, node: ast.Expr, frame: Frame) -> Signal:
        """Run a call or another expression."""
        value = self.evaluate(node.value, frame)
        return Raised() if isinstance(value, Library) and value.path == "sys.exit()" else None

    def run_assignment(self, node: ast.Assign, frame: Frame) -> Signal:
        """Run `a = b = value`."""
        value = self.evaluate(node.value, frame)
        for target in node.targets:
            self.assign(target, value, frame)
        return None

    def run_annotated(self, node: ast.AnnAssign, frame: Frame) -> Signal:
        """Run `a: type = value`."""
        if node.value is not None:
            self.assign(node.target, self.evaluate(node.value, frame), frame)
        return None

    def run_augmented(self, node: ast.AugAssign, frame: Frame) -> Signal:
        """Run `a += value`; a list changes in place."""
        before, value = self.evaluate(node.target, frame), self.evaluate(node.value, frame)
        if isinstance(before, Items) and isinstance(node.op, ast.Add):
            found = self.iterate(value)
            self.append(before, [value] if found is None else found)
            return None
        try:
            changed = self.weigh(binary(type(node.op), before, value))
        except (ExpressionError, UnsupportedError) as error:
            changed = self.failed(error)
        self.assign(node.target, changed, frame)
        return None

    def assign(self, target: ast.expr, value: Value, frame: Frame) -> None:
        """Bind a target of an assignment or loop."""
        if isinstance(target, ast.Attribute):
            receiver = self.evaluate(target.value, frame)
            if isinstance(receiver, Instance):
                receiver.attributes[target.attr] = value
        elif isinstance(target, ast.Subscript):
            receiver, key = self.evaluate(target.value, frame), self.evaluate(target.slice, frame)
            if isinstance(receiver, Table):
                self.put(receiver, key, value, self.location(target, frame))
            elif isinstance(receiver, Items) and isinstance(key, int) and -len(receiver) <= key < len(receiver):
                self.keep(receiver)
                receiver[key] = self.guarded(value, receiver.guards)

            elif isinstance(receiver, Method) and isinstance(receiver.receiver, ContextValue):
                self._configure(receiver.receiver, key, value)
        else:
            super().assign(target, value, frame)

    def _configure(self, receiver: ContextValue, key: Value, value: Value) -> None:
        """Run `context.launch_configurations[key] = value`."""
        name = known(key, self.context)
        if receiver.context is not None and name is not None:
            guarded = Unknown(f"it depends on `{self.guards[-1].written}`") if self.guards else value
            receiver.context.scope.configurations[name] = receiver.context.perform(to_text(guarded))

    def run_return(self, node: ast.Return, frame: Frame) -> Signal:
        """Run `return value`."""
        return Return(self.evaluate(node.value, frame) if node.value else None)

    def run_if(self, node: ast.If, frame: Frame) -> Signal:
        """Run the branch that is taken; both where that cannot be known."""
        found = truth(self.evaluate(node.test, frame), self.context)
        if found is not None:
            return self.run_block(node.body if found else node.orelse, frame)
        return self.fork(written(node.test), node.body, node.orelse, frame)

    def fork(self, words: str, body: Sequence[ast.stmt], other: Sequence[ast.stmt], frame: Frame) -> Signal:
        """Run two blocks of which one is taken, on a condition of these words; what follows sees both."""
        before, height = frame.scope.names, len(self.guards)
        outcomes: list[_Outcome] = []
        for condition, block in (
            (Condition(None, written=words), body),
            (Condition(None, negated=True, written=words), other),
        ):
            frame.scope.names = dict(before)
            self.guards.append(condition)
            signal = self.run_block(block, frame)
            del self.guards[height:]
            if not isinstance(signal, Raised):  # a launch that fails is no configuration
                outcomes.append((condition, signal, frame.scope.names))
        if not outcomes:
            return Raised()
        if len(outcomes) == 1:
            frame.scope.names = outcomes[0][2]
            return outcomes[0][1]
        return self._meet(outcomes[0], outcomes[1], frame)

    def _meet(self, first: _Outcome, second: _Outcome, frame: Frame) -> Signal:
        """Go on behind two branches: with both, or with the one that does not end here."""
        if first[1] is None and second[1] is None:
            frame.scope.names = _merged(first, second)
            return None
        if isinstance(first[1], Return) and isinstance(second[1], Return):
            return Return(Choice(((first[0], first[1].value), (second[0], second[1].value))))
        ends, goes = (first, second) if second[1] is None or isinstance(first[1], Return) else (second, first)
        if isinstance(ends[1], Return):
            frame.pending.append((ends[0], ends[1].value))
        frame.scope.names = goes[2]
        self.guards.append(goes[0])
        return goes[1]

    def run_for(self, node: ast.For | ast.AsyncFor, frame: Frame) -> Signal:
        """Run a loop over known items; over unknown ones its body once, under a condition."""
        iterated = self.evaluate(node.iter, frame)
        items = self.iterate(iterated)
        if items is None:
            height = len(self.guards)
            words = f"for {written(node.target)} in {written(node.iter)}"
            self.guards.append(Condition(None, written=words))
            self.assign(node.target, Unknown(reason_of(iterated)), frame)
            signal = self.run_block(node.body, frame)
            del self.guards[height:]
            if isinstance(signal, Return):
                frame.pending.append((Condition(None, written=words), signal.value))
            return None
        for item in items[:_MAX_ROUNDS]:
            signal = self._round(node, item, frame)
            if isinstance(signal, Break):
                return None
            if isinstance(signal, Return | Raised):
                return signal
        if len(items) > _MAX_ROUNDS:
            self.note(LaunchProblemKind.LIMIT, _TOO_LONG, self.location(node, frame))
        return self.run_block(node.orelse, frame)

    def _round(self, node: ast.For | ast.AsyncFor, item: Value, frame: Frame) -> Signal:
        height = len(self.guards)
        if isinstance(item, Guarded):
            self.guards.append(item.condition)
        self.assign(node.target, item.value if isinstance(item, Guarded) else item, frame)
        signal = self.run_block(node.body, frame)
        if not frame.pending:
            del self.guards[height:]
        return signal

    def run_while(self, node: ast.While, frame: Frame) -> Signal:
        """Run a loop while its condition is known to hold; its body once where it is not known."""
        for _ in range(_MAX_ROUNDS):
            found = truth(self.evaluate(node.test, frame), self.context)
            if found is None:
                return self.fork(written(node.test), node.body, node.orelse, frame)
            if not found:
                return self.run_block(node.orelse, frame)
            signal = self.run_block(node.body, frame)
            if isinstance(signal, Break):
                return None
            if isinstance(signal, Return | Raised):
                return signal
        self.note(LaunchProblemKind.LIMIT, _TOO_LONG, self.location(node, frame))
        return None

    def run_try(self, node: ast.Try, frame: Frame) -> Signal:
        """Run the body; the first handler where it certainly raises."""
        signal = self.run_block(node.body, frame)
        if isinstance(signal, Raised) and node.handlers:
            handler = node.handlers[0]
            if handler.name:
                frame.scope.bind(handler.name, Unknown("an exception"))
            signal = self.run_block(handler.body, frame)
        elif signal is None:
            signal = self.run_block(node.orelse, frame)
        last = self.run_block(node.finalbody, frame)
        return last if last is not None else signal

    def run_with(self, node: ast.With | ast.AsyncWith, frame: Frame) -> Signal:
        """Run the body with what is entered; open files are themselves."""
        for item in node.items:
            value = self.evaluate(item.context_expr, frame)
            if item.optional_vars is not None:
                entered = value if isinstance(value, LoadedFile | Unknown) else Unknown(reason_of(value))
                self.assign(item.optional_vars, entered, frame)
        return self.run_block(node.body, frame)

    def run_function(self, node: ast.FunctionDef | ast.AsyncFunctionDef, frame: Frame) -> Signal:
        """Define a function; decorators but those of methods make it unknown."""
        function = Function(node, frame.module, frame.scope, node.name, self.defaults(node.args, frame))
        frame.scope.bind(node.name, function)
        return None

    def run_class(self, node: ast.ClassDef, frame: Frame) -> Signal:
        """Define a class."""
        scope = Scope(parent=frame.scope)
        bases = tuple(self.evaluate(base, frame) for base in node.bases)
        self.run_block(node.body, Frame(frame.module, scope))
        marks = " ".join(written(each) for each in node.decorator_list)
        fields = [
            each.target.id
            for each in node.body
            if isinstance(each, ast.AnnAssign) and isinstance(each.target, ast.Name) and "dataclass" in marks
        ]
        frame.scope.bind(node.name, Klass(node.name, scope, bases, tuple(fields)))
        return None

    def run_import(self, node: ast.Import, frame: Frame) -> Signal:
        """Bind modules."""
        for alias in node.names:
            first = alias.name.partition(".")[0]
            name = alias.name if alias.asname else first
            frame.scope.bind(alias.asname or first, self.module_named(name, frame.module))
        return None

    def run_import_from(self, node: ast.ImportFrom, frame: Frame) -> Signal:
        """Bind names of a module."""
        module = "." * node.level + (node.module or "")
        for alias in node.names:
            if alias.name == "*":
                frame.scope.names.update(self.star(module, frame.module))
            else:
                found = self.member_of_module(module, alias.name, frame.module)
                frame.scope.bind(alias.asname or alias.name, found)
        return None

    def run_match(self, node: ast.Match, frame: Frame) -> Signal:
        """Run `match` as the chain of `if` that it is; patterns that are no values may match."""
        chain: list[ast.stmt] = []
        for case in reversed(node.cases):
            test = _matches(node.subject, case.pattern)
            if case.guard is not None:
                test = ast.BoolOp(ast.And(), [test, case.guard])
            chain = [ast.copy_location(ast.If(test, case.body, chain), case.pattern)]
        return self.run_block([ast.fix_missing_locations(each) for each in chain], frame)

    def run_outer(self, node: ast.Global | ast.Nonlocal, frame: Frame) -> Signal:
        """Let assignments to names be those of an outer scope."""
        frame.scope.outer.update(node.names)
        return None

    def run_delete(self, node: ast.Delete, frame: Frame) -> Signal:
        """Remove names and entries of dictionaries."""
        for target in node.targets:
            if isinstance(target, ast.Name):
                frame.scope.names.pop(target.id, None)
            elif isinstance(target, ast.Subscript):
                receiver, key = self.evaluate(target.value, frame), self.evaluate(target.slice, frame)
                if isinstance(receiver, Table) and isinstance(key, str):
                    receiver.pop(key, None)
        return None


def _matches(subject: ast.expr, pattern: ast.pattern) -> ast.expr:
    """Return the test that a pattern makes of a subject."""
    if isinstance(pattern, ast.MatchValue):
        return ast.Compare(subject, [ast.Eq()], [pattern.value])
    if isinstance(pattern, ast.MatchSingleton):
        return ast.Compare(subject, [ast.Is()], [ast.Constant(pattern.value)])
    if isinstance(pattern, ast.MatchOr):
        return ast.BoolOp(ast.Or(), [_matches(subject, each) for each in pattern.patterns])
    if isinstance(pattern, ast.MatchAs) and pattern.pattern is None:
        return ast.NamedExpr(ast.Name(pattern.name), subject) if pattern.name else ast.Constant(value=True)
    return ast.Compare(subject, [ast.Is()], [ast.Name("<pattern>")])


def _merged(first: _Outcome, second: _Outcome) -> dict[str, Value]:
    """Return names after two branches: what differs is a choice."""
    merged: dict[str, Value] = {}
    for name in dict.fromkeys([*first[2], *second[2]]):
        one, other = first[2].get(name, merged), second[2].get(name, merged)
        if same(one, other):
            merged[name] = one
            continue
        options = ((first[0], one), (second[0], other))
        merged[name] = Choice(tuple(option for option in options if option[1] is not merged))
    return merged


_RUNNERS: Final[dict[type[ast.stmt], Callable[..., Signal]]] = {
    ast.Expr: Statements.run_expression,
    ast.Assign: Statements.run_assignment,
    ast.AnnAssign: Statements.run_annotated,
    ast.AugAssign: Statements.run_augmented,
    ast.Return: Statements.run_return,
    ast.If: Statements.run_if,
    ast.For: Statements.run_for,
    ast.AsyncFor: Statements.run_for,
    ast.While: Statements.run_while,
    ast.Try: Statements.run_try,
    ast.With: Statements.run_with,
    ast.AsyncWith: Statements.run_with,
    ast.FunctionDef: Statements.run_function,
    ast.AsyncFunctionDef: Statements.run_function,
    ast.ClassDef: Statements.run_class,
    ast.Import: Statements.run_import,
    ast.ImportFrom: Statements.run_import_from,
    ast.Match: Statements.run_match,
    ast.Global: Statements.run_outer,
    ast.Nonlocal: Statements.run_outer,
    ast.Delete: Statements.run_delete,
    ast.Raise: lambda *_: Raised(),
    ast.Break: lambda *_: Break(),
    ast.Continue: lambda *_: Continue(),
}
