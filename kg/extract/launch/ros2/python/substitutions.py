"""The substitutions and conditions of launch and launch_ros: objects of their classes become parts of texts.

Sources: `launch.substitutions`, `launch.conditions`, `launch_ros.substitutions`, `nav2_common.launch`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.actions import ParameterFile
from kg.extract.launch.ros2.python.values import (
    Made,
    entries_of,
    guarded,
    launch_text,
    reason_of,
)
from kg.extract.launch.ros2.texts import Condition, Substitution, join, unknown_text
from kg.symbolic.values import Either, Mapping, Sequence, Text, Truth, Unknown, Value

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.launch.ros2.texts import Text as LaunchText
    from kg.facts import Location

__all__ = [
    "CONDITIONS",
    "PLAIN",
    "SUBSTITUTIONS",
    "condition",
    "condition_on",
    "file_of",
    "is_substitution",
    "pairs_of",
    "substituted",
]

CONDITIONS: Final[dict[str, tuple[str, ...]]] = {
    "IfCondition": ("predicate_expression",),
    "UnlessCondition": ("predicate_expression",),
    "LaunchConfigurationEquals": ("launch_configuration_name", "expected_value"),
    "LaunchConfigurationNotEquals": ("launch_configuration_name", "expected_value"),
}
"""The names of the parameters of each condition, in order."""


def condition_on(made: Made) -> Condition | None:
    """Return the condition of an action; one that is not known is kept in the words of the file."""
    value = made.value("condition")
    if value is None:
        return None
    if isinstance(value, Made) and value.name in CONDITIONS:
        return condition(value)
    return Condition(None, written=made.words("condition"))


def condition(made: Made) -> Condition:
    """Return what an object of a condition stands for."""
    negated = made.name.startswith(("Unless", "LaunchConfigurationNot"))
    name, *expected = CONDITIONS[made.name]
    held = made.value(name)
    if isinstance(held, Unknown | Either):
        return Condition(None, negated=negated, written=made.words(name))
    if not expected:
        return Condition(made.text(name) or (), negated=negated, written=made.words(name))
    operands = (Substitution("var", (made.text(name) or (), ())),), made.text(expected[0]) or ()
    return Condition((Substitution("equals", operands),), negated=negated, written=made.words(""))


PLAIN: Final[dict[str, tuple[str, ...]]] = {
    "Command": ("command", "command"),
    "FindExecutable": ("find-exec", "name"),
    "ExecutableInPackage": ("exec-in-pkg", "executable", "package"),
    "FindPackage": ("find-pkg-prefix", "package"),
    "FindPackagePrefix": ("find-pkg-prefix", "package"),
    "FindPackageShare": ("find-pkg-share", "package"),
    "ThisLaunchFileDir": ("dirname",),
    "ThisLaunchFile": ("filename",),
    "AnonName": ("anon", "name"),
    "FileContent": ("file-content", "path"),
    "LocalSubstitution": ("local", "expression"),
    "NotSubstitution": ("not", "value"),
    "AndSubstitution": ("and", "left", "right"),
    "OrSubstitution": ("or", "left", "right"),
    "EqualsSubstitution": ("equals", "left", "right"),
    "NotEqualsSubstitution": ("not-equals", "left", "right"),
    "PythonExpression": ("eval", "expression"),
    "LaunchConfiguration": ("var", "variable_name", "default"),
    "LaunchConfigAsBool": ("var", "variable_name", "default"),
    "EnvironmentVariable": ("env", "name", "default_value"),
}
"""Substitutions whose operands are their arguments, by class: the kind, and the arguments in order."""
_UNKNOWN: Final[dict[str, str]] = {
    "LaunchLogDir": "the folder of the log files",
    "LaunchConfigurationContext": "a configuration of another file",
    "HasNodeParams": "whether a parameter file has a section for a node",
}


def substituted(made: Made) -> LaunchText:
    """Return the text that an object of launch gives when it is substituted."""
    name = made.name
    if name in PLAIN:
        kind, *names = PLAIN[name]
        operands = [made.text(one) for one in names]
        if kind == "eval" and operands[0] is None:
            operands = [()]
        return (Substitution(kind, tuple(operand for operand in operands if operand is not None)),)
    if name in _UNKNOWN:
        return unknown_text(_UNKNOWN[name])
    read = SUBSTITUTIONS.get(name)
    return read[1](made) if read is not None else unknown_text(f"a `{name}` cannot stand here")


def is_substitution(value: Value) -> bool:
    """Tell whether a value is an object that is substituted later."""
    return isinstance(value, Made) and (value.name in PLAIN or value.name in SUBSTITUTIONS or value.name in _UNKNOWN)


def _text(made: Made) -> LaunchText:
    return made.text("text") or ()


def _items(made: Made, name: str) -> list[Value] | None:
    value = made.value(name)
    return list(value.items) if isinstance(value, Sequence) else None


def _path(made: Made) -> LaunchText:
    found = _items(made, "substitutions")
    operands = [launch_text(part) for part in found] if found is not None else [made.text("substitutions") or ()]
    return (Substitution("path-join", tuple(operands)),)


def _several(kind: str) -> Callable[[Made], LaunchText]:
    """Return the reader of a substitution of any number of operands, given one by one or as a list."""

    def read(made: Made) -> LaunchText:
        values = list(made.given.values)
        if len(values) == 1 and isinstance(values[0], Sequence):
            values = list(values[0].items)
        return (Substitution(kind, tuple(launch_text(value) for value in values if not guarded(value)[1])),)

    return read


def _choice(made: Made) -> LaunchText:
    chosen = made.text("if_value"), made.text("else_value")
    operands = tuple(("",) if operand is None else operand for operand in chosen)
    return (Substitution("if", (made.text("condition") or (), *operands)),)


def _joined(made: Made) -> LaunchText:
    parts: list[str | Substitution] = []
    for number, value in enumerate(_items(made, "substitutions") or ()):
        parts += [*((made.text("delimiter") or ()) if number else ()), *launch_text(value)]
    return join(parts)


def _described(made: Made) -> LaunchText:
    """Return the text that xacro prints of a file: `xacro.process_file(path, mappings={...})`."""
    words: list[str | Substitution] = ["xacro ", *(made.text("input_file_name") or ())]
    for name, value in entries_of(made.value("mappings")):
        words += [f" {launch_text(name)[0] if launch_text(name) else ''}:=", *launch_text(value)]
    return (Substitution("command", (join(words),)),)


def pairs_of(made: Made, name: str) -> tuple[tuple[LaunchText, LaunchText], ...]:
    """Return the entries of a dictionary that is an argument."""
    return tuple((launch_text(key), launch_text(value)) for key, value in entries_of(made.value(name)))


def _replaced(made: Made) -> LaunchText:
    """Return nav2's `ReplaceString`: the name of a copy of a file in which texts are replaced."""
    condition = condition_on(made)
    held: LaunchText = ("true",)
    if condition is not None and condition.value is None:
        held = unknown_text(f"it depends on `{condition.words}`")
    elif condition is not None and condition.value is not None:
        held = (Substitution("not", (condition.value,)),) if condition.negated else condition.value
    pairs = pairs_of(made, "replacements")
    operands = (made.text("source_file") or (), held, *(text for pair in pairs for text in pair))
    return (Substitution("replaced-file", operands),)


_REWRITES: Final = ("param_rewrites", "key_rewrites", "value_rewrites")


def file_of(value: Value | None, location: Location) -> ParameterFile:
    """Return a file of parameters; its path is unknown if the value is."""
    if isinstance(value, Made) and value.name == "ParameterFile":
        inner = file_of(value.value("param_file"), value.location)
        allowed = value.fields.get("allow_substs", Truth(False))
        off = allowed == Truth(False) or (isinstance(allowed, Text) and allowed.known in ("false", "False"))
        return replace(inner, location=value.location, substitutions=not off)
    if isinstance(value, Made) and value.name == "RewrittenYaml":
        root, given = value.text("root_key"), [value.value(name) for name in _REWRITES]
        unknown = next((one for one in given if one not in (None, Text.of("")) and not isinstance(one, Mapping)), None)
        return ParameterFile(
            (value.text("source_file") or ())
            if unknown is None
            else unknown_text(f"what a file of parameters is rewritten with: {reason_of(unknown)}"),
            value.location,
            rewrites=pairs_of(value, "param_rewrites"),
            root=root or None,
            keys=pairs_of(value, "key_rewrites"),
            values=pairs_of(value, "value_rewrites"),
        )
    return ParameterFile(launch_text(value) if value is not None else (), location)


def _file(made: Made) -> LaunchText:
    return file_of(made, made.location).read


SUBSTITUTIONS: Final[dict[str, tuple[tuple[str, ...], Callable[[Made], LaunchText]]]] = {
    "TextSubstitution": (("text",), _text),
    "BooleanSubstitution": (("text",), _text),
    "PathJoinSubstitution": (("substitutions",), _path),
    "PathSubstitution": (("substitutions",), _path),
    "AnySubstitution": ((), _several("any")),
    "AllSubstitution": ((), _several("all")),
    "IfElseSubstitution": (("condition", "if_value", "else_value"), _choice),
    "StringJoinSubstitution": (("substitutions", "delimiter"), _joined),
    "process_file": (("input_file_name",), _described),
    "ReplaceString": (("source_file",), _replaced),
    "RewrittenYaml": (("source_file",), _file),
    "ParameterFile": (("param_file",), _file),
}
"""Other substitutions by class: the names of their parameters in order, and what they give."""
