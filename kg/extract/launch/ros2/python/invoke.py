"""Calls: functions and classes of the build are run in place, those of Python and ROS are looked up in tables."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, Final

from kg.extract.launch.expressions.functions import FUNCTIONS as PLAIN
from kg.extract.launch.expressions.methods import method
from kg.extract.launch.expressions.texts import known, reason_of, simplify, to_text, words, written
from kg.extract.launch.expressions.values import (
    Choice,
    Condition,
    Frame,
    Function,
    Items,
    Library,
    Method,
    Scope,
    Table,
    Unknown,
    Words,
)
from kg.extract.launch.ros2.actions import ParameterFile
from kg.extract.launch.ros2.context import HOLE
from kg.extract.launch.ros2.python.call import Call
from kg.extract.launch.ros2.python.library import FUNCTIONS
from kg.extract.launch.ros2.python.machine import Return
from kg.extract.launch.ros2.python.methods import file_method, path_method
from kg.extract.launch.ros2.python.modules import Modules
from kg.extract.launch.ros2.python.values import ContextValue, Description, Instance, Klass, LoadedFile, PathValue

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.extract.launch.expressions.values import Value

__all__ = ["Invocations"]

_MAX_DEPTH: Final = 24
_PRINTED: Final = frozenset({"toxml", "toprettyxml"})
"""Methods of what `xacro.process_file` gives; here that is its text already."""


class Invocations(Modules):
    """The part of the interpreter that calls."""

    def invoke(
        self, function: Value, args: Sequence[Value], kwargs: Mapping[str, Value], node: ast.expr, frame: Frame
    ) -> Value:
        """Return what a call gives."""
        if isinstance(function, Function):
            return self.run(function, list(args), dict(kwargs), node)
        if isinstance(function, Klass):
            return self.construct(function, list(args), dict(kwargs), node, frame)
        path = function.path if isinstance(function, Library) else ""
        call = Call(self, path, node, frame, list(args), dict(kwargs))
        if isinstance(function, Library):
            return self._library(function, call)
        if isinstance(function, Method):
            return self._method(function.receiver, function.name, call)
        if isinstance(function, Choice):
            made = ((condition, self.invoke(each, args, kwargs, node, frame)) for condition, each in function.options)
            return Choice(tuple(made))
        return Unknown(function.reason if isinstance(function, Unknown) else f"`{written(node)}` calls no function")

    def _library(self, function: Library, call: Call) -> Value:
        plain = PLAIN.get(function.path)
        if plain is not None:
            return plain(call)
        own = FUNCTIONS.get(function.path) or FUNCTIONS.get(function.name)
        if own is not None:
            return own(call)
        if function.path in {"sys.exit", "builtins.exit", "builtins.quit"}:
            return Library("sys.exit()")
        return Unknown(f"`{function.path.removeprefix('builtins.')}()` is not run")

    def _method(self, receiver: Value, name: str, call: Call) -> Value:
        if isinstance(receiver, Words | ParameterFile) and name in {"perform", "evaluate"}:
            return self.perform(receiver)
        if isinstance(receiver, Words) and name in _PRINTED:
            return receiver
        if isinstance(receiver, str | Words | Items | tuple | Table):
            return method(call, receiver, name)
        if isinstance(receiver, PathValue):
            return path_method(call, receiver, name)
        if isinstance(receiver, LoadedFile):
            return file_method(call, receiver, name)
        if isinstance(receiver, Description):
            return self._describe(receiver, name, call)
        if isinstance(receiver, Choice):
            made = ((condition, self._method(each, name, call)) for condition, each in receiver.options)
            return Choice(tuple(made))
        if isinstance(receiver, Condition) and name == "evaluate":
            return self._holds_now(receiver)
        if isinstance(receiver, Method) and isinstance(receiver.receiver, ContextValue):
            return self._configurations(receiver.receiver, name, call)
        if isinstance(receiver, ContextValue) and name == "perform_substitution":
            return self.perform(call.value("substitution", 0))
        return Unknown(f"`{name}()`: {reason_of(receiver)}")

    def _describe(self, receiver: Description, name: str, call: Call) -> Value:
        if name in {"add_action", "add_entity"}:
            value = call.value("action" if name == "add_action" else "entity", 0)
            value = Unknown(value.reason, value.place or call.location) if isinstance(value, Unknown) else value
            self.append(receiver.entities, [value])
            return None
        return receiver.entities if name == "describe_sub_entities" else Unknown(f"`{name}()` of a description")

    def _configurations(self, receiver: ContextValue, name: str, call: Call) -> Value:
        """Return what a method of `context.launch_configurations` gives."""
        key = known(call.value("key", 0), self.context)
        if name == "get" and key is not None:
            found = self.configuration(receiver, key)
            unset = receiver.context is not None and receiver.context.configuration(key) is None
            return call.value("default", 1) if unset else found
        return Unknown(f"`launch_configurations.{name}()` is not read")

    def _holds_now(self, condition: Condition) -> Value:
        if self.context is None or condition.value is None:
            return Unknown(f"the condition `{condition.written}` is evaluated where it cannot be known")
        text = self.context.perform(condition.value).strip().lower()
        if text not in {"true", "1", "false", "0"}:
            return Unknown(f"it depends on `{condition.written}`")
        return (text in {"true", "1"}) is not condition.negated

    def perform(self, value: Value) -> Value:
        """Return the text that a substitution gives now."""
        parts = to_text(value)
        if self.context is None:
            return simplify(parts)  # in a context of the file's own, which has no configurations
        found = self.context.perform(parts)
        if HOLE not in found:
            return found
        names = [part.arguments[0] for part in parts if not isinstance(part, str) and part.kind == "var"]
        name = "".join(str(part) for part in names[0]) if names else ""
        reason = f"the launch configuration `{name}` is not known" if name else reason_of(value)
        return words(found, reason, HOLE)

    def run(self, function: Function, args: list[Value], kwargs: dict[str, Value], node: ast.expr) -> Value:
        """Return what a function of the build gives; its body is run in place."""
        if self.depth >= _MAX_DEPTH:
            return Unknown(f"the calls of `{function.name}` are nested too deeply")
        if function.bound:
            args = [function.receiver, *args]
        scope = Scope(parent=function.scope)
        self._bind(function, args, kwargs, scope)
        frame = Frame(function.module, scope)
        self.depth, height = self.depth + 1, len(self.guards)
        try:
            if isinstance(function.node, ast.Lambda):
                return self.evaluate(function.node.body, frame)
            if _yields(function.node):
                return Unknown(f"`{written(node)}` is a generator")
            return self._ended(frame, function.node.body, height)
        except RecursionError:
            return Unknown(f"the calls of `{function.name}` are nested too deeply")
        finally:
            self.depth -= 1
            del self.guards[height:]

    def _ended(self, frame: Frame, body: Sequence[ast.stmt], height: int) -> Value:
        """Run a body and return its value: a choice where it may end in several places."""
        signal = self.run_block(body, frame)
        value = signal.value if isinstance(signal, Return) else None
        if not frame.pending:
            return value
        rest = self.guards[height:]
        return Choice((*frame.pending, (rest[-1] if rest else None, value)))

    def _bind(self, function: Function, args: list[Value], kwargs: dict[str, Value], scope: Scope) -> None:
        parameters = function.node.args
        positional = [argument.arg for argument in (*parameters.posonlyargs, *parameters.args)]
        left = dict(kwargs)
        for number, name in enumerate(positional):
            missing = Unknown(f"the argument `{name}` of `{function.name}` is not given")
            value = function.defaults.get(name, missing)
            scope.names[name] = args[number] if number < len(args) else left.pop(name, value)
        for argument in parameters.kwonlyargs:
            missing = Unknown(f"the argument `{argument.arg}` of `{function.name}` is not given")
            scope.names[argument.arg] = left.pop(argument.arg, function.defaults.get(argument.arg, missing))
        if parameters.vararg:
            scope.names[parameters.vararg.arg] = tuple(args[len(positional) :])
        if parameters.kwarg:
            table = self.table()
            table.update(left)
            scope.names[parameters.kwarg.arg] = table

    def construct(
        self, klass: Klass, args: list[Value], kwargs: dict[str, Value], node: ast.expr, frame: Frame
    ) -> Value:
        """Return an object of a class of the build."""
        if any(not isinstance(base, Klass) and base != Library("builtins.object") for base in klass.bases):
            return Unknown(f"the class `{klass.name}` has a base that is not in the build")
        instance = Instance(klass)
        found, maker = klass.find("__init__")
        if found and isinstance(maker, Function):
            self.invoke(self.bound(maker, instance), args, kwargs, node, frame)
            return instance
        for name, value in zip(klass.dataclass_fields, args, strict=False):
            instance.attributes[name] = value
        instance.attributes.update({name: value for name, value in kwargs.items() if name in klass.dataclass_fields})
        return instance


def _yields(node: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    """Tell whether a function is a generator; a function defined in it counts too, which errs on the safe side."""
    return any(isinstance(each, ast.Yield | ast.YieldFrom) for each in ast.walk(node))
