"""Parameters of nodes: their values, defaults and types, as calls declare, read and write them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from kg.facts import Access, Resolution
from kg.symbolic.names import EMPTY, NODE_NAME, OWN_NAMESPACE, below, namespace_of
from kg.symbolic.values import (
    Either,
    Enumerator,
    Guard,
    Kind,
    Mapping,
    Number,
    Object,
    Sequence,
    Text,
    Truth,
    TypeValue,
    Unknown,
    Value,
    concatenate,
    join,
    number,
    without_default,
    worse,
)

if TYPE_CHECKING:
    from kg.symbolic.descriptions import Effect
    from kg.symbolic.language import Language
    from kg.symbolic.state import Invocation

_INTEGERS: Final = frozenset(
    {
        "int",
        "int64_t",
        "int32_t",
        "long",
        "size_t",
        "uint8_t",
        "uint16_t",
        "uint32_t",
        "uint64_t",
        "int8_t",
        "int16_t",
        "unsigned",
        "short",
    }
)
_DESCRIPTORS: Final = ("ParameterType", "ParameterDescriptor")
_BEGINNINGS: Final[dict[str | None, Value]] = {
    "string": EMPTY,
    "bool": Truth(False),
    "int": Number(0, "0"),
    "double": Number(0.0, "0.0"),
}
"""The value of a default `{}`, by the type of the parameter; that of a list is a list."""


@dataclass(frozen=True, slots=True)
class Reading:
    """One access to a parameter: its name, its value, the default that the access gives, and the type."""

    name: Text | Unknown
    value: Value
    before: Value | None
    """The value of the output variable before the call."""
    default: Value | None
    type: str | None


class Parameters:
    """The values of the parameters of each node, as far as calls declare or read them."""

    def __init__(self) -> None:
        self._values: dict[tuple[int | None, str], Value] = {}
        self._declared: set[tuple[int | None, str]] = set()
        self._dynamic: set[tuple[int | None, str]] = set()
        """The parameters that may have values of any type."""

    def declares(self, node: Value | None, name: str) -> bool:
        """Check whether a parameter of a node is declared; that it is read does not say so."""
        return (id(node), name) in self._declared

    def read(self, language: Language, effect: Effect, owner: Object | None, name: Value, call: Invocation) -> Reading:
        """Return an access to a parameter, and remember the value for accesses without default."""
        prefix = _prefix(effect, call)
        whole = _whole_name(owner, prefixed(prefix, name) if prefix is not None else name)
        shown = whole.shown if isinstance(whole, Text) else None
        default = call.argument(effect.default) if effect.value is None else _literal(effect.value)
        if isinstance(default, Object) and (default.kind.name in _DESCRIPTORS or _is_blank(default)):
            default = None
        if isinstance(default, Sequence) and _is_pair(default) and default.items[0] == name:
            default = default.items[1]  # a `rclcpp::Parameter` of that name
        if isinstance(default, Enumerator) and default.number is not None:
            default = number(default.number, default.parameter)
        template = call.arguments.template
        stated = _stated_type(default)
        if isinstance(default, TypeValue):
            default = None
        written = effect.output is not None and effect.output < len(call.arguments.written)
        before = call.argument(effect.output) if written and call.arguments.frame is not None else None
        if isinstance(before, Sequence) and _is_pair(before):
            before = before.items[1]  # a `rclcpp::Parameter` that receives the parameter
        other = getattr(before, "parameter", None) not in (None, shown)  # the variable has received another parameter
        key = (id(owner) if owner is not None and "of" not in owner.native else None, shown or "")
        current = self._values.get(key) if shown is not None and effect.access is not Access.WRITE else None
        if effect.access is Access.DECLARE and shown is not None:
            self._declared.add(key)
        kind = stated or _type(template, default, before if not other else None)
        if kind is None:
            declared = call.declared(effect.output, language) or call.declared(effect.default, language)
            kind = ros_type(declared) if declared is not None else next(iter(effect.types), None)
        if default == Sequence(()):
            default = _BEGINNINGS.get(kind, default)
        value = _value(default, current, before, shown)
        if kind == "bool" and isinstance(default, Number | Text):  # an address of a text is true in C++
            default = Truth(not isinstance(default, Number) or default.value != 0, default.parameter)
        descriptor = call.argument(effect.descriptor)
        if isinstance(descriptor, Object) and descriptor.fields.get("dynamic_typing") == Truth(True):
            self._dynamic.add(key)
        if key in self._dynamic:
            kind = None
        elif isinstance(descriptor, Object) and kind is None:
            kind = _stated_type(descriptor.fields.get("type"))
        reading = Reading(whole, value, before, default, kind)
        if shown is not None and effect.access is not Access.WRITE and (default is not None or current is None):
            self._values[key] = value
        if effect.weak and current is not None:
            typed = kind or (type_of_value(current) if key not in self._dynamic else None)
            return replace(reading, default=None, type=typed)
        first = effect.access is Access.READ and current is None and before is not None and not other
        if default is None and first and not isinstance(value, Unknown):
            return replace(reading, default=value)
        return reading


def _literal(value: str | float) -> Value:
    """Return a value of a description."""
    if isinstance(value, bool):
        return Truth(value)
    return Text.of(value) if isinstance(value, str) else number(value)


def _whole_name(owner: Object | None, name: Value) -> Text | Unknown:
    namespace = namespace_of(owner)
    rooted = isinstance(name, Text) and (
        name.parts[0] in (NODE_NAME, OWN_NAMESPACE) or (name.exact or "x").startswith(("~", "/"))
    )
    whole = below(namespace, name) if namespace != EMPTY or rooted else name
    return whole if isinstance(whole, (Text, Unknown)) else Unknown("the name of the parameter is not known")


def _value(default: Value | None, current: Value | None, before: Value | None, name: str | None) -> Value:
    if default is not None and not isinstance(default, Unknown):
        return with_parameter(default, name)
    if current is not None:
        return current
    if isinstance(before, (Number, Truth)) or (isinstance(before, Text) and before.exact):
        return with_parameter(before, name)
    if name is None:
        return Unknown("it is a parameter with an unknown name")
    return without_default(name)


def with_parameter(value: Value, name: str | None) -> Value:
    """Return a value as the default of a parameter."""
    if isinstance(value, Either):
        return join(*(with_parameter(item, name) for item in value.items))
    if isinstance(value, Text):
        resolution = worse(value.resolution, Resolution.PARAMETER_DEFAULT)
        return replace(value, parameter=name, resolution=resolution, own=True)
    if isinstance(value, Number):
        return replace(value, parameter=name, own=True)
    if isinstance(value, (Truth, Enumerator, Sequence, Mapping)):
        return replace(value, parameter=name)
    if isinstance(value, Guard):
        return Unknown("it depends on a parameter", name)
    return value


def listed(effect: Effect, call: Invocation) -> list[list[Value]]:
    """Return the parameters in a list or map, each with its name below the prefix of the call, value and descriptor."""
    given = call.argument(effect.name or 0)
    if effect.access is Access.WRITE and _is_pair(given):
        given = Sequence((given,)) if given is not None else None
    missing = Unknown("no default")
    rows: list[list[Value]] = []
    if effect.prefix is not None and effect.prefix == effect.name:
        rows.append([Text.hole("the code reads all parameters below a prefix"), missing])
    if isinstance(given, Mapping):
        rows += map(list, given.items)
    for item in given.items if isinstance(given, Sequence) else ():
        row = list(item.items) if isinstance(item, Sequence) and item.items else [item]
        rows.append(row if len(row) > 1 else [*row, missing])
    prefix = _prefix(effect, call)
    return [[prefixed(prefix, row[0]), *row[1:]] for row in rows] if prefix is not None else rows


def _prefix(effect: Effect, call: Invocation) -> Value | None:
    """Return the prefix of the names of parameters; None if there is none."""
    if isinstance(effect.prefix, str):
        return Text.hole("the loader of the plugin gives its name", effect.prefix)
    return call.argument(effect.prefix)


def prefixed(prefix: Value, name: Value) -> Value:
    """Return the name of a parameter below a prefix, which can end with the dot that separates them."""
    if isinstance(prefix, Text) and prefix.exact == "":
        return name
    last = prefix.parts[-1] if isinstance(prefix, Text) else None
    dot = "" if isinstance(last, str) and last.endswith(".") else "."
    return concatenate(prefix, Text.of(dot), name)


def _stated_type(default: Value | None) -> str | None:
    """Return the type that `Parameter.Type.STRING` or `ParameterType.PARAMETER_STRING` states."""
    names = default.kind.names if isinstance(default, TypeValue) else ()
    if names[-2:-1] not in (("Type",), ("ParameterType",)):
        return None
    word = names[-1].lower().removeprefix("parameter_")
    return {"integer": "int", "integer_array": "int_array"}.get(word, word) if word != "not_set" else None


def _is_blank(of: Object) -> bool:
    """Return whether an object of a class outside was made of nothing, so that it is not a default."""
    return of.kind.cls is None and of.native.get("empty") == Truth(True)


def _is_pair(value: Value | None) -> bool:
    return isinstance(value, Sequence) and len(value.items) == 2 and isinstance(value.items[0], Text)  # noqa: PLR2004 - a pair


def _type(template: tuple[Value, ...], default: Value | None, before: Value | None) -> str | None:
    first = template[0] if template else None
    explicit = ros_type(first.kind) if isinstance(first, TypeValue) else None
    return explicit or type_of_value(default) or type_of_value(before)


def ros_type(kind: Kind) -> str | None:
    """Return the type of a parameter that a variable of a type holds."""
    name = kind.name
    if name in ("string", "basic_string"):
        return "string"
    if name == "bool":
        return "bool"
    if name in ("double", "float"):
        return "double"
    if name in _INTEGERS:
        return "int"
    if name in ("vector", "array") and kind.arguments and isinstance(kind.arguments[0], TypeValue):
        inner = ros_type(kind.arguments[0].kind)
        return f"{inner}_array" if inner is not None else None
    return None


def type_of_value(value: Value | None) -> str | None:
    """Return the type of a parameter with a value."""
    if isinstance(value, Either):
        known = (one for one in value.items if not (isinstance(one, Text) and one.wholly_unknown))
        return type_of_value(next(known, value.items[0]))
    if isinstance(value, Text):
        return "string"
    if isinstance(value, (Truth, Guard)):
        return "bool"
    if isinstance(value, Number):
        return "double" if value.floating else "int"
    if isinstance(value, Sequence) and value.items:
        inner = type_of_value(value.items[0])
        return f"{inner}_array" if inner else None
    return None
