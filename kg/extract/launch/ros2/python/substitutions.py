"""The substitutions of launch and launch_ros: calls of their classes become parts of texts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.launch.expressions.texts import to_text
from kg.extract.launch.expressions.values import Guarded, Items, Substitution, Words

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.launch.expressions.values import Text, Value
    from kg.extract.launch.ros2.python.call import Call

__all__ = ["SUBSTITUTIONS"]


def _made(kind: str, *arguments: Text) -> Words:
    return Words((Substitution(kind, arguments),), lazy=True)


def _plain(kind: str, *names: str) -> Callable[[Call], Value]:
    """Return the maker of a substitution whose operands are these arguments; those that are not given are left out."""

    def make(call: Call) -> Value:
        operands = [call.text(name, position) for position, name in enumerate(names)]
        return _made(kind, *[operand for operand in operands if operand is not None])

    return make


def _text(call: Call) -> Value:
    return Words(call.text("text", 0) or (), lazy=True)


def _configuration(call: Call) -> Value:
    name, default = to_text(call.value("variable_name", 0)), call.value("default", None)
    return _made("var", name) if default is None else _made("var", name, to_text(default))


def _variable(call: Call) -> Value:
    default = call.text("default_value")
    name = call.text("name", 0) or ()
    return _made("env", name) if default is None else _made("env", name, default)


def _joined_path(call: Call) -> Value:
    found = call.machine.iterate(call.value("substitutions", 0))
    if found is None:
        return _made("path-join", to_text(call.value("substitutions", 0)))
    return _made("path-join", *[to_text(part) for part in found])


def _path(call: Call) -> Value:
    return _made("path-join", call.text("path", 0) or ())


def _expression(call: Call) -> Value:
    return _made("eval", call.text("expression", 0) or ())


def _several(kind: str) -> Callable[[Call], Value]:
    """Return the maker of a substitution of any number of operands, given one by one or as a list."""

    def make(call: Call) -> Value:
        values = call.args
        if len(values) == 1 and isinstance(values[0], Items | tuple):
            values = list(values[0])
        return _made(kind, *[to_text(value) for value in values if not isinstance(value, Guarded)])

    return make


def _choice(call: Call) -> Value:
    condition, empty = call.text("condition", 0) or (), ("",)
    chosen = call.text("if_value", 1), call.text("else_value", 2)
    return _made("if", condition, *[empty if operand is None else operand for operand in chosen])


def _joined(call: Call) -> Value:
    found = call.machine.iterate(call.value("substitutions", 0)) or []
    delimiter = call.text("delimiter", 1) or ()
    parts: list[str | Substitution] = []
    for number, value in enumerate(found):
        parts += [*(delimiter if number else ()), *to_text(value)]
    return Words(tuple(parts), lazy=True)


def _unknown(reason: str) -> Callable[[Call], Value]:
    return lambda _: Words((Substitution("unknown", reason=reason),), lazy=True)


SUBSTITUTIONS: Final[dict[str, Callable[[Call], Value]]] = {
    "TextSubstitution": _text,
    "LaunchConfiguration": _configuration,
    "LaunchConfigAsBool": _configuration,
    "EnvironmentVariable": _variable,
    "PathJoinSubstitution": _joined_path,
    "PathSubstitution": _path,
    "PythonExpression": _expression,
    "Command": _plain("command", "command"),
    "FindExecutable": _plain("find-exec", "name"),
    "ExecutableInPackage": _plain("exec-in-pkg", "executable", "package"),
    "FindPackage": _plain("find-pkg-prefix", "package"),
    "FindPackagePrefix": _plain("find-pkg-prefix", "package"),
    "FindPackageShare": _plain("find-pkg-share", "package"),
    "ThisLaunchFileDir": _plain("dirname"),
    "ThisLaunchFile": _plain("filename"),
    "AnonName": _plain("anon", "name"),
    "FileContent": _plain("file-content", "path"),
    "LocalSubstitution": _plain("local", "expression"),
    "StringJoinSubstitution": _joined,
    "NotSubstitution": _plain("not", "value"),
    "AndSubstitution": _plain("and", "left", "right"),
    "OrSubstitution": _plain("or", "left", "right"),
    "AnySubstitution": _several("any"),
    "AllSubstitution": _several("all"),
    "EqualsSubstitution": _plain("equals", "left", "right"),
    "NotEqualsSubstitution": _plain("not-equals", "left", "right"),
    "IfElseSubstitution": _choice,
    "BooleanSubstitution": _text,
    "Parameter": _unknown("the value of a parameter set by an outer action"),
    "LaunchLogDir": _unknown("the folder of the log files"),
    "LaunchConfigurationContext": _unknown("a configuration of another file"),
    "HasNodeParams": _unknown("whether a parameter file has a section for a node"),
}
