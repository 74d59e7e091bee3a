"""What calls of the C++ standard library, Boost and fmt make of strings, numbers and containers."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.extract.cpp import syntax
from kg.extract.values import (
    COMMAND_LINE,
    HOLE,
    Mapping,
    Number,
    Sequence,
    Text,
    Truth,
    Unknown,
    Value,
    argument_at,
    concatenate,
    part_of_parameter,
)
from kg.facts import Resolution

if TYPE_CHECKING:
    from tree_sitter import Node

    from kg.extract.cpp.context import Context
    from kg.extract.cpp.evaluate import Alternatives, Evaluator
    from kg.extract.cpp.types import TypeName
    from kg.extract.cpp.unit import Expr

__all__ = ["add", "at", "compute", "construct", "evaluate", "formatted", "number", "operands", "pattern"]

_SAME: Final = frozenset(
    [
        "string",
        "c_str",
        "str",
        "data",
        "get",
        "move",
        "forward",
        "as_string",
        "value",
        "string_view",
        "to_string",
        "lexical_cast",
        "ref",
        "cref",
        "value_to_string",
        "std_string",
        "static_cast",
        "const_cast",
        "dynamic_cast",
        "reinterpret_cast",
        "native",
        "generic_string",
        "clone",
        "trim",
        "as_int",
        "as_double",
        "as_bool",
        "value_or",
        "toStdString",
    ]
)
_TEXTS: Final = frozenset({"string", "basic_string", "string_view", "path", "String", "stringstream", "ostringstream"})
_CONTAINERS: Final = frozenset({"vector", "array", "list", "set", "deque", "initializer_list", "unordered_set"})
_MAPS: Final = frozenset({"map", "unordered_map", "multimap"})
_HANDED: Final = frozenset(
    {"shared_ptr", "unique_ptr", "char", "auto", "int", "double", "bool", "ParameterValue", "format"}
)
_PRINTF: Final = re.compile(r"%[-+ #0]*\d*(?:\.\d+)?(?:hh|h|ll|l|z|j|t)?[a-zA-Z]|%\d+%|%%")
_BRACES: Final = re.compile(r"\{[^{}]*\}")
_PAIR: Final = 2
_ARGUMENT_LISTS: Final = frozenset({"remove_ros_arguments", "init_and_remove_ros_arguments"})
"""Functions that give the arguments of the program, from `argc` and `argv`, as a list."""


def number(written: str) -> Value:
    """Return a number literal; its text stays as written, without C++ suffixes."""
    plain = written.replace("'", "").rstrip("fFlLuU") if not written.startswith(("0x", "0X")) else written
    try:
        value = float(int(plain, 0)) if not any(c in plain for c in ".eE") else float(plain)
    except ValueError:
        try:
            value = float(plain)
        except ValueError:
            return Unknown("it is no plain number")
    return Number(value, plain)


def operands(node: Node, sign: str) -> list[Node]:
    """Return the operands of a chain of one left-associative operator, without recursion."""
    found: list[Node] = []
    while node.type == "binary_expression":
        operator = node.child_by_field_name("operator")
        left, right = node.child_by_field_name("left"), node.child_by_field_name("right")
        if operator is None or left is None or right is None or syntax.text(operator) != sign:
            break
        found.append(right)
        node = left
    found.append(node)
    return found[::-1]


def add(values: list[Value]) -> Value:
    """Return the sum of numbers, or the concatenation of texts."""
    if all(isinstance(value, Number) for value in values):
        total = sum(value.value for value in values if isinstance(value, Number))
        return _as_number(total)
    return concatenate(*(Unknown("it is computed") if isinstance(v, Truth | Sequence | Mapping) else v for v in values))


def compute(sign: str, values: list[Value]) -> Value:
    """Return the result of arithmetic on numbers; `/` between texts joins paths."""
    if sign == "/" and any(isinstance(value, Text) for value in values):
        pieces: list[Value] = [values[0]]
        for value in values[1:]:
            pieces += [Text.of("/"), value]
        return concatenate(*pieces)
    numbers = [value.value for value in values if isinstance(value, Number)]
    if len(numbers) != len(values) or not numbers:
        return Unknown("it is computed at run time")
    result = numbers[0]
    for other in numbers[1:]:
        if sign == "/" and not other:
            return Unknown("it divides by zero")
        result = result - other if sign == "-" else result * other if sign == "*" else result / other
    return _as_number(result)


def _as_number(value: float) -> Number:
    return Number(value, str(int(value)) if value.is_integer() else repr(value))


def at(container: Value, key: Value) -> list[Value]:
    """Return the elements that an index can mean: one if both are known, all where only the container is."""
    if container == COMMAND_LINE:
        return [argument_at(key)]
    if isinstance(container, Text) and container.resolution is Resolution.LAUNCH_ARGUMENT:
        return [container]
    if isinstance(container, Text) and container.parameter is not None and container.parts == (HOLE,):
        return [part_of_parameter(container, key)]
    if isinstance(container, Sequence):
        if isinstance(key, Number):
            index = int(key.value)
            return [container.items[index]] if 0 <= index < len(container.items) else []
        return list(container.items)
    if isinstance(container, Mapping):
        if isinstance(key, Text) and key.known is not None:
            wanted = key.known
            return [v for k, v in container.items if isinstance(k, Text) and k.known == wanted]
        return [v for _, v in container.items]
    return []


def construct(evaluator: Evaluator, kind: TypeName, given: list[Expr], context: Context) -> Alternatives | None:
    """Return what an object of a library type is when it is made from arguments."""
    name = kind.name
    if name in _TEXTS:
        if not given:
            return [(Text.of(""), context)]
        return [(v, c) if isinstance(v, Text) else (concatenate(v), c) for v, c in evaluator.values(given[0], context)]
    if name in _CONTAINERS:
        if len(given) == 1 and given[0].node.type != "initializer_list":
            element = evaluator.values(given[0], context)
            if any(isinstance(value, Sequence) for value, _ in element):
                return element
        if len(given) == _PAIR and [value for value, _ in evaluator.values(given[0], context)] == [COMMAND_LINE]:
            return [(COMMAND_LINE, context)]  # `args(argv, argv + argc)`
        if len(given) == 1 and given[0].node.type == "initializer_list":
            given = [given[0].child(child) for child in syntax.arguments(given[0].node)]
        return [(Sequence(tuple(row)), chosen) for row, chosen in evaluator.product(given, context)]
    if name in _MAPS:
        if len(given) == 1 and given[0].node.type == "initializer_list":
            inner = [given[0].child(child) for child in syntax.arguments(given[0].node)]
            given = inner if all(child.node.type == "initializer_list" for child in inner) else given
        return [(_mapping(row), chosen) for row, chosen in evaluator.product(given, context)]
    if name in _HANDED or (len(given) == 1 and given[0].node.type == "new_expression"):
        return evaluator.values(given[0], context) if given else None
    return None


def _mapping(row: list[Value]) -> Value:
    pairs = [value.items for value in row if isinstance(value, Sequence) and len(value.items) == _PAIR]
    return Mapping(tuple((pair[0], pair[1]) for pair in pairs))


def evaluate(
    evaluator: Evaluator, where: Expr, called: syntax.Callee, given: list[Expr], context: Context
) -> Alternatives | None:
    """Return what a call of a library function makes; None for functions not known here."""
    name, receiver = called.name, called.receiver
    if name in ("getenv", "secure_getenv"):
        return [(Unknown("it comes from the environment"), context)]
    if name == "string" and not given and receiver is None:
        return [(Text.of(""), context)]
    if name in _SAME:
        source = where.child(receiver) if receiver is not None else given[0] if given else None
        return _as_texts(evaluator, source, context, name) if source is not None else None
    if name in ("append", "concat") and receiver is not None and given:
        return evaluator.joined([where.child(receiver), given[0]], context)
    if name in ("size", "length") and receiver is not None:
        return [(_size(value), chosen) for value, chosen in evaluator.values(where.child(receiver), context)]
    if name == "at" and receiver is not None and given:
        return evaluator.element(where.child(receiver), given[0], context)
    if name == "substr" and receiver is not None and given:
        rows = evaluator.product([where.child(receiver), *given], context)
        return [(_slice(row), chosen) for row, chosen in rows]
    if name == "format" and given:
        return [(formatted(row), chosen) for row, chosen in evaluator.product(given, context)]
    if name in _ARGUMENT_LISTS and len(given) > 1:
        return evaluator.values(given[1], context)
    if name in ("StrCat", "append_path") and given:
        return evaluator.joined(given, context)
    return None


def _as_texts(evaluator: Evaluator, source: Expr, context: Context, name: str) -> Alternatives:
    found: Alternatives = []
    for value, chosen in evaluator.values(source, context):
        number_made_text = isinstance(value, Number) and name in ("to_string", "lexical_cast", "string")
        found.append((concatenate(value), chosen) if number_made_text else (value, chosen))
    return found


def _size(value: Value) -> Value:
    if isinstance(value, Sequence | Mapping):
        return _as_number(float(len(value.items)))
    return Unknown("its size is not known")


def pattern(node: Node) -> Node | None:
    """Return the text in `boost::format(text)`; None for other expressions."""
    node = syntax.unwrap(node)
    function = node.child_by_field_name("function") if node.type == "call_expression" else None
    given = syntax.arguments(node.child_by_field_name("arguments")) if function is not None else []
    return given[0] if function is not None and given and syntax.simple_name(function) == "format" else None


def _slice(row: list[Value]) -> Value:
    text, *bounds = row
    numbers = [int(bound.value) for bound in bounds if isinstance(bound, Number)]
    if not isinstance(text, Text) or text.known is None or len(numbers) != len(bounds):
        return Unknown("it is a part of a text that is cut at run time")
    end = numbers[0] + numbers[1] if len(numbers) > 1 else None
    return replace(text, parts=(text.known[numbers[0] : end],))


def formatted(row: list[Value]) -> Value:
    """Return `fmt::format`, `boost::format` or `printf`-like formatting of known texts."""
    pattern, *values = row
    if not isinstance(pattern, Text) or pattern.known is None:
        return Unknown("the format is not known")
    regular = _BRACES if _BRACES.search(pattern.known) else _PRINTF
    pieces: list[Value] = []
    position, index = 0, 0
    for match in regular.finditer(pattern.known):
        pieces.append(Text.of(pattern.known[position : match.start()]))
        position = match.end()
        if match.group() == "%%":
            pieces.append(Text.of("%"))
            continue
        hole = Text((HOLE,), Resolution.PARTIAL, reason="a value is put in at run time")
        pieces.append(values[index] if index < len(values) else hole)
        index += 1
    pieces.append(Text.of(pattern.known[position:]))
    return concatenate(
        *(piece for piece in pieces if not (isinstance(piece, Text) and piece.parts == ("",))), Text.of("")
    )
