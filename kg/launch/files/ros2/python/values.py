"""Values of launch files, in addition to those of the interpreter: objects, substitutions, and conditions.

An alternative carries the conditions that lead to it: `Fork`s in the ways of `Either`. An `Either` of one alternative
is there only under its conditions.
"""

from __future__ import annotations

import ast
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from kg.holes import Hole
from kg.launch.files.ros2.actions import Condition, ParameterFile, Part, Substitution, join, unknown_text
from kg.launch.files.ros2.actions import Text as LaunchText
from kg.symbolic import form
from kg.symbolic.operators import NULL, plain
from kg.symbolic.spelling import spelled
from kg.symbolic.values import (
    Either,
    Mapping,
    Number,
    Object,
    Sequence,
    Text,
    Truth,
    Unknown,
    Value,
    concatenate,
    paths,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from kg.facts import Location
    from kg.symbolic.form import Expression, Unit
    from kg.symbolic.state import Arguments

_MOST_PARTS: Final = 2_000
_LONGEST: Final = 200
_PLACED: Final = (
    form.Literal, form.Name, form.Member, form.Call, form.Unary, form.Binary, form.Choice, form.Index, form.Display,
    form.Pairs, form.Lambda, form.Assign, form.Opaque, form.Spread,
)  # fmt: skip
MARK: Final = "?"
"""Begins the term of a condition that cannot be known: the words of the file follow."""


@dataclass(frozen=True, slots=True, eq=False)
class Later(Hole):
    """A part of a text that is known only when an action is executed."""

    part: Substitution = Substitution("unknown")  # noqa: RUF009 - it is immutable

    __eq__ = object.__eq__
    __hash__ = object.__hash__


@dataclass(frozen=True, slots=True, eq=False)
class Fork:
    """An undecided choice: the terms of each side. Outer ones have higher numbers."""

    number: int
    terms: tuple[tuple[str, ...], ...]


@dataclass(slots=True, eq=False, kw_only=True)
class Instance(Object):
    """An object of a class of launch: its arguments by name in `fields`, and the call that made it."""

    given: Arguments
    location: Location
    names: tuple[str, ...] = ()
    """The names of its parameters in order."""
    substituted: LaunchText | None = None
    """What it gives when it is substituted, once that was read."""

    @property
    def name(self) -> str:
        """The name of its class."""
        return self.kind.name

    def value(self, name: str) -> Value | None:
        """Return an argument; None if it is not given or None."""
        value = self.fields.get(name)
        return None if value == NULL else value

    def first(self, *names: str) -> Value | None:
        """Return the argument given by one of several names; None if there is none."""
        return next((value for name in names if (value := self.value(name)) is not None), None)

    def text(self, name: str) -> LaunchText | None:
        """Return an argument as a text; None if it is not given."""
        value = self.value(name)
        return None if value is None else launch_text(value)

    def expression(self, name: str) -> Expression | None:
        """Return the expression of an argument; None if it is not written at the call itself."""
        call = self.given.call
        if call is None:
            return None
        index = self.names.index(name) if name in self.names else len(call.arguments)
        return dict(call.keywords).get(name, call.arguments[index] if index < len(call.arguments) else None)

    def place(self, name: str) -> Location:
        """Return the place of an argument; that of the call if it is unknown."""
        written = self.expression(name)
        return replace(self.location, line=written.line) if isinstance(written, _PLACED) else self.location

    def words(self, name: str) -> str:
        """Return an argument, or the call, in the words of the file."""
        frame, written = self.given.frame, self.expression(name) or self.given.call
        return words(written, frame.unit) if written is not None and frame is not None else ""


def words(element: object, unit: Unit) -> str:
    """Return an element of the form in the words of the file, in one line."""
    sources = getattr(unit, "sources", None) or {}
    node = sources.get(element)
    if node is None:
        return spelled(element) if isinstance(element, _PLACED) else ""
    text = node.text.decode("utf-8", "replace")
    with suppress(SyntaxError, ValueError, RecursionError):
        text = ast.unparse(ast.parse(f"({text}\n)", mode="eval"))
    return " ".join(text.split())[:_LONGEST]


def terms_of_way(way: Iterable[tuple[object, int]]) -> tuple[str, ...]:
    """Return the terms of an alternative, those of outer branches first."""
    forks = sorted(((fork, side) for fork, side in way if isinstance(fork, Fork)), key=lambda one: -one[0].number)
    return tuple(dict.fromkeys(term for fork, side in forks for term in fork.terms[side]))


def condition_of(terms: tuple[str, ...]) -> Condition | None:
    """Return terms as a condition that cannot be known; None for no terms."""
    conditions = [Condition(None, term.startswith("!"), term.lstrip(f"!{MARK}")) for term in terms]
    if len(conditions) > 1:
        return Condition(None, written=" and ".join(condition.words for condition in conditions))
    return conditions[0] if conditions else None


def options(value: Value) -> list[tuple[Condition | None, Value]]:
    """Return the alternatives of a value, each with its condition."""
    return [(condition_of(terms_of_way(way)), item) for item, way in paths(value)]


def guarded(item: Value) -> tuple[Value, tuple[str, ...]]:
    """Return an item of a list that may be there only under conditions, and their terms."""
    if isinstance(item, Either) and len(item.items) == 1:
        return item.items[0], terms_of_way(item.ways[0] if item.ways else ())
    return item, ()


def reason_of(value: Value | None) -> str:
    """Return why a value cannot be used as what it should be."""
    if isinstance(value, Either):
        written = next((one.written for one, _ in options(value) if one is not None), "")
        return f"it depends on `{written}`"
    if isinstance(value, Unknown):
        return value.reason
    if isinstance(value, Instance):
        parts = [part for part in launch_text(value) if isinstance(part, Substitution)]
        return _why(parts[0]) if parts else f"a `{value.name}` is not allowed here"
    if isinstance(value, Text):
        later_part = next((part for part in value.parts if isinstance(part, Later)), None)
        return _why(later_part.part) if later_part is not None else value.reason or "a text is not allowed here"
    return f"a value of the type {type(value).__name__.lower()} is not allowed here"


def _why(part: Substitution) -> str:
    return part.reason or f"a substitution `{part.kind}` is known only when it is executed"


def later(kind: str, *arguments: LaunchText) -> Text:
    """Return a text that is one substitution."""
    return Text((Later(part=Substitution(kind, arguments)),))


def text_of(parts: Iterable[Part]) -> Text:
    """Return a text of launch as a value."""
    pieces = (Text((part,)) if isinstance(part, str) else Text((Later(part=part),)) for part in parts)
    text = concatenate(*pieces)
    return text if isinstance(text, Text) else Text(("",))


def launch_text(value: Value) -> LaunchText:
    """Return a value as the text that launch makes of it: a text, a substitution, or a list of both to be joined."""
    if isinstance(value, Text):
        reason = value.reason or "it is not known"
        parts: list[Part] = []
        for part in value.parts:
            if isinstance(part, Later):
                parts.append(part.part)
            else:
                parts.append(part if isinstance(part, str) else Substitution("unknown", reason=reason))
        return join(parts)
    if isinstance(value, Instance):
        if value.substituted is None:
            value.substituted = substituted(value)
        return value.substituted
    if isinstance(value, Either):
        return _common(value)
    if isinstance(value, Number | Truth):
        return (str(plain(value)),)
    if isinstance(value, Sequence):
        return join([part for item in value.items[:_MOST_PARTS] for part in launch_text(item)])
    return unknown_text(reason_of(value))


def _common(value: Either) -> LaunchText:
    """Return the common prefix and suffix of several texts, with an unknown part between."""
    texts = [item.exact or "" for item in value.items if isinstance(item, Text) and item.exact is not None]
    if len(texts) < len(value.items) or len(texts) == 1:
        return unknown_text(reason_of(value))
    first = _shared(texts)
    last = _shared([text[len(first) :][::-1] for text in texts])[::-1]
    return join([first, *unknown_text(reason_of(value)), last])


def _shared(texts: list[str]) -> str:
    """Return the common prefix of all texts, up to the end of a word."""
    columns = enumerate(zip(*texts, strict=False))
    end = next((index for index, letters in columns if len(set(letters)) > 1), min(map(len, texts)))
    while end and texts[0][end - 1].isalnum() and any(text[end : end + 1].isalnum() for text in texts):
        end -= 1
    return texts[0][:end]


def pair_of(value: Value) -> tuple[Value, Value] | None:
    """Return the two items of a list of two; None for all else."""
    if isinstance(value, Sequence) and len(value.items) == 2 and not value.open:  # noqa: PLR2004 - a pair
        return value.items[0], value.items[1]
    return None


def entries_of(value: Value | None) -> list[tuple[Value, Value]]:
    """Return the entries of a dictionary; none of other values."""
    return list(value.items) if isinstance(value, Mapping) else []


CONDITIONS: Final[dict[str, tuple[str, ...]]] = {
    "IfCondition": ("predicate_expression",),
    "UnlessCondition": ("predicate_expression",),
    "LaunchConfigurationEquals": ("launch_configuration_name", "expected_value"),
    "LaunchConfigurationNotEquals": ("launch_configuration_name", "expected_value"),
}
"""The names of the parameters of each condition, in order."""


def condition_on(instance: Instance) -> Condition | None:
    """Return the condition of an action; one that is not known is kept in the words of the file."""
    value = instance.value("condition")
    if value is None:
        return None
    if isinstance(value, Instance) and value.name in CONDITIONS:
        return condition(value)
    return Condition(None, written=instance.words("condition"))


def condition(instance: Instance) -> Condition:
    """Return the condition of an object."""
    negated = instance.name.startswith(("Unless", "LaunchConfigurationNot"))
    name, *expected = CONDITIONS[instance.name]
    operand = instance.value(name)
    if isinstance(operand, Unknown | Either):
        return Condition(None, negated=negated, written=instance.words(name))
    if not expected:
        return Condition(instance.text(name) or (), negated=negated, written=instance.words(name))
    operands = (Substitution("var", (instance.text(name) or (), ())),), instance.text(expected[0]) or ()
    return Condition((Substitution("equals", operands),), negated=negated, written=instance.words(""))


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
    "HasNodeParams": ("has-node-params", "source_file", "node_name"),
}
"""Substitutions whose operands are their arguments, by class: the kind, and the arguments in order."""
_OWN: Final = frozenset({"Substitution"})
"""The class that substitutions of the sources extend."""
_UNKNOWN: Final[dict[str, str]] = {
    "LaunchLogDir": "the folder of the log files",
    "LaunchConfigurationContext": "a configuration of another file",
}


def substituted(instance: Instance) -> LaunchText:
    """Return the text that an object of launch gives when it is substituted."""
    name = instance.name
    if name in PLAIN:
        kind, *names = PLAIN[name]
        operands = [instance.text(one) for one in names]
        if kind == "eval" and operands[0] is None:
            operands = [()]
        return (Substitution(kind, tuple(operand for operand in operands if operand is not None)),)
    if name in _UNKNOWN:
        return unknown_text(_UNKNOWN[name])
    if name in _OWN and instance.kind.cls is not None:
        return unknown_text(f"the code of the substitution `{instance.kind.cls.name}` is not run")
    read = SUBSTITUTIONS.get(name)
    return read[1](instance) if read is not None else unknown_text(f"a `{name}` is not allowed here")


def is_substitution(value: Value) -> bool:
    """Return whether a value is an object that is substituted later."""
    return isinstance(value, Instance) and any(value.name in names for names in (PLAIN, SUBSTITUTIONS, _UNKNOWN, _OWN))


def _text(instance: Instance) -> LaunchText:
    return instance.text("text") or ()


def _items(instance: Instance, name: str) -> list[Value] | None:
    value = instance.value(name)
    return list(value.items) if isinstance(value, Sequence) else None


def _path(instance: Instance) -> LaunchText:
    parts = _items(instance, "substitutions")
    operands = [launch_text(part) for part in parts] if parts is not None else [instance.text("substitutions") or ()]
    return (Substitution("path-join", tuple(operands)),)


def _several(kind: str) -> Callable[[Instance], LaunchText]:
    """Return the reader of a substitution of any number of operands, given one by one or as a list."""

    def read(instance: Instance) -> LaunchText:
        values = list(instance.given.values)
        if len(values) == 1 and isinstance(values[0], Sequence):
            values = list(values[0].items)
        return (Substitution(kind, tuple(launch_text(value) for value in values if not guarded(value)[1])),)

    return read


def _choice(instance: Instance) -> LaunchText:
    chosen = instance.text("if_value"), instance.text("else_value")
    operands = tuple(("",) if operand is None else operand for operand in chosen)
    return (Substitution("if", (instance.text("condition") or (), *operands)),)


def _joined(instance: Instance) -> LaunchText:
    parts: list[str | Substitution] = []
    for number, value in enumerate(_items(instance, "substitutions") or ()):
        parts += [*((instance.text("delimiter") or ()) if number else ()), *launch_text(value)]
    return join(parts)


def _described(instance: Instance) -> LaunchText:
    """Return the text that xacro prints of a file: `xacro.process_file(path, mappings={...})`."""
    words: list[str | Substitution] = ["xacro ", *(instance.text("input_file_name") or ())]
    for name, value in entries_of(instance.value("mappings")):
        words += [f" {launch_text(name)[0] if launch_text(name) else ''}:=", *launch_text(value)]
    return (Substitution("command", (join(words),)),)


def pairs_of(instance: Instance, name: str) -> tuple[tuple[LaunchText, LaunchText], ...]:
    """Return the entries of a dictionary that is an argument."""
    return tuple((launch_text(key), launch_text(value)) for key, value in entries_of(instance.value(name)))


def _replaced(instance: Instance) -> LaunchText:
    """Return nav2's `ReplaceString`: the name of a copy of a file in which texts are replaced."""
    condition = condition_on(instance)
    applies: LaunchText = ("true",)
    if condition is not None and condition.value is None:
        applies = unknown_text(f"it depends on `{condition.words}`")
    elif condition is not None and condition.value is not None:
        applies = (Substitution("not", (condition.value,)),) if condition.negated else condition.value
    pairs = pairs_of(instance, "replacements")
    operands = (instance.text("source_file") or (), applies, *(text for pair in pairs for text in pair))
    return (Substitution("replaced-file", operands),)


_REWRITES: Final = ("param_rewrites", "key_rewrites", "value_rewrites")


def file_of(value: Value | None, location: Location) -> ParameterFile:
    """Return a file of parameters; its path is unknown if the value is."""
    if isinstance(value, Instance) and value.name == "ParameterFile":
        inner = file_of(value.value("param_file"), value.location)
        allowed = value.fields.get("allow_substs", Truth(False))
        off = allowed == Truth(False) or (isinstance(allowed, Text) and allowed.exact in ("false", "False"))
        return replace(inner, location=value.location, substitutions=not off)
    if isinstance(value, Instance) and value.name == "RewrittenYaml":
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


def _file(instance: Instance) -> LaunchText:
    return file_of(instance, instance.location).read


SUBSTITUTIONS: Final[dict[str, tuple[tuple[str, ...], Callable[[Instance], LaunchText]]]] = {
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
