"""Calls that read, write or declare a parameter, as facts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.cpp import syntax
from kg.extract.cpp.context import EMPTY
from kg.extract.cpp.handles import joined_name
from kg.extract.values import Handle, Mapping, Number, Sequence, Text, Truth, Unknown, Value
from kg.facts import Parameter, Resolution

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.extract.cpp.api import ParameterSpec
    from kg.extract.cpp.context import Context
    from kg.extract.cpp.evaluate import Evaluator
    from kg.extract.cpp.syntax import Callee
    from kg.extract.cpp.types import TypeName
    from kg.extract.cpp.unit import Expr
    from kg.facts import Location

__all__ = ["read_listed", "read_parameter", "yaml"]

_SCALARS: Final = {
    "bool": "bool",
    "int": "int",
    "int64_t": "int",
    "int32_t": "int",
    "uint32_t": "int",
    "uint16_t": "int",
    "uint8_t": "int",
    "size_t": "int",
    "unsigned": "int",
    "long": "int",
    "short": "int",
    "double": "double",
    "float": "double",
    "string": "string",
    "String": "string",
}
_DYNAMIC: Final = b"dynamic_typing"
"""In a descriptor, lets a parameter of ROS 2 take values of any type; for which ones is not followed."""


def read_parameter(  # noqa: PLR0913, PLR0917 - the parts of one call
    evaluator: Evaluator, spec: ParameterSpec, where: Expr, called: Callee, given: list[Expr], place: Location
) -> Iterator[Parameter]:
    """Yield the parameters that a call can mean, one for each alternative of its name."""
    handle = where.child(called.receiver) if called.receiver is not None else None
    if spec.handle is not None:
        handle = given[spec.handle]
    holders = evaluator.values(handle, EMPTY) if handle is not None and spec.ros == 1 else [(Handle(), EMPTY)]
    for holder, after in holders:
        namespace = holder.namespace if isinstance(holder, Handle) else Text.of("")
        for name, chosen in evaluator.texts(given[spec.name], after):
            default = _default(evaluator, spec, given, chosen)
            kind = _type(evaluator, spec, called, where, given, chosen) or _type_of_value(default)
            if _DYNAMIC in where.unit.source:
                kind = None
            if isinstance(name, Unknown):
                reason = name.reason
                yield Parameter(None, kind, yaml(default), spec.access, place, Resolution.UNRESOLVED, reason=reason)
                continue
            full = joined_name(namespace, name)
            whole = None not in full.parts
            resolution = full.resolution if whole else Resolution.PARTIAL
            pattern = full.pattern
            if pattern is None:
                resolution = Resolution.UNRESOLVED
            yield Parameter(pattern, kind, yaml(default), spec.access, place, resolution, reason=full.reason)


def read_listed(evaluator: Evaluator, spec: ParameterSpec, given: list[Expr], place: Location) -> Iterator[Parameter]:
    """Yield the parameters that a call like `declare_parameters("prefix", {{"name", default}, ...})` lists."""
    prefixes: list[tuple[Text | Unknown, Context]] = [(Text.of(""), EMPTY)]
    if spec.default is not None:
        prefixes = evaluator.texts(given[spec.default], EMPTY)
    for prefix, after in prefixes:
        above = prefix.pattern if isinstance(prefix, Text) else "{}"
        for value, _ in evaluator.values(given[spec.name], after):
            held = Sequence((value,)) if spec.single else value
            for name, default in _entries(held):
                pattern = f"{above}.{name.pattern}" if above else name.pattern
                resolution = Resolution.PARTIAL if pattern is None or "{}" in pattern else name.resolution
                yield Parameter(pattern, _type_of_value(default), yaml(default), spec.access, place, resolution)


def _entries(held: Value) -> Iterator[tuple[Text, Value | None]]:
    """Yield the names that a list or map holds, each with its value if it has one."""
    if isinstance(held, Mapping):
        yield from ((key, value) for key, value in held.items if isinstance(key, Text))
    for item in held.items if isinstance(held, Sequence) else ():
        if isinstance(item, Text):
            yield item, None
        elif isinstance(item, Sequence) and item.items and isinstance(item.items[0], Text):
            yield item.items[0], item.items[1] if len(item.items) > 1 else None


def _default(evaluator: Evaluator, spec: ParameterSpec, given: list[Expr], context: Context) -> Value | None:
    if spec.default is None or spec.default >= len(given):
        return None
    values = evaluator.values(given[spec.default], context)
    return values[0][0] if len(values) == 1 else None


def _type(  # noqa: PLR0913, PLR0917 - the parts of one call
    evaluator: Evaluator, spec: ParameterSpec, called: Callee, where: Expr, given: list[Expr], context: Context
) -> str | None:
    explicit = syntax.arguments(called.template)
    if explicit:
        settled = evaluator.types.settle(where.child(explicit[0]), context)
        return ros_type(settled[0][0]) if settled else None
    index = spec.output if spec.output is not None else spec.default
    if index is None or index >= len(given):
        return None
    kind = evaluator.types.of(given[index], context)
    return ros_type(kind) if kind is not None else None


def ros_type(kind: TypeName) -> str | None:
    """Return the parameter type that a C++ type stands for."""
    if kind.name in ("vector", "array", "list") and kind.arguments:
        inner = syntax.simple_name(kind.arguments[0].node)
        scalar = _SCALARS.get(inner)
        return f"{scalar}_array" if scalar is not None else None
    if kind.name in ("map", "unordered_map"):
        return "dict"
    return _SCALARS.get(kind.name.split(" ")[-1])


def _type_of_value(value: Value | None) -> str | None:
    if isinstance(value, Text):
        return "string" if value.known is not None else None
    if isinstance(value, Truth):
        return "bool"
    if isinstance(value, Number):
        return (
            "double" if any(mark in value.written for mark in ".eE") and not value.written.startswith("0x") else "int"
        )
    return None


def yaml(value: Value | None) -> str | None:
    """Return a value as YAML; None where it is not known."""
    if isinstance(value, Text):
        return _quoted(value.known) if value.known is not None else None
    if isinstance(value, Truth):
        return "true" if value.value else "false"
    if isinstance(value, Number):
        return value.written
    if isinstance(value, Sequence):
        items = [yaml(item) for item in value.items]
        return None if None in items else "[" + ", ".join(item for item in items if item is not None) + "]"
    return None


def _quoted(text: str) -> str:
    plain = text.replace("_", "").replace("/", "").replace("~", "").replace("-", "")
    if (
        plain.isalnum()
        and not plain.isdigit()
        and text.lower() not in ("true", "false", "null", "yes", "no", "on", "off")
    ):
        return text
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'
