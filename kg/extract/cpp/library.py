"""Types and functions of the C++ standard library, Boost and fmt, over abstract values."""

from __future__ import annotations

import math
import re
import sys
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

from kg.extract.cpp import packs, tokens
from kg.extract.cpp.formats import WITH_ARGUMENT, formatted, manipulator
from kg.facts import Resolution
from kg.holes import label_of
from kg.symbolic import form
from kg.symbolic.binding import put
from kg.symbolic.containers import COMMAND_LINE, between, element, elements, is_unset, moved, with_element
from kg.symbolic.kinds import pointee
from kg.symbolic.names import NODE_NAME, OWN_NAMESPACE, PARENT_NAMESPACE
from kg.symbolic.operators import compute, negate
from kg.symbolic.state import Arguments, Frame
from kg.symbolic.values import (
    LENGTH,
    UNASSIGNED,
    Bound,
    Closure,
    Either,
    Enumerator,
    Guard,
    Kind,
    Mapping,
    Number,
    Object,
    Pack,
    Sequence,
    Text,
    Truth,
    TypeValue,
    Unknown,
    Value,
    alternatives,
    as_text,
    bound_call,
    concatenate,
    join,
    number,
    over,
    read_back,
    worse,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.cpp.language import Cpp
    from kg.symbolic.form import Expression, Type

TEXTS: Final[frozenset[str]] = frozenset({"string", "basic_string", "string_view", "path", "String", "QString"})
STREAMS: Final = tokens.STREAMS
NPOS: Final = number(float(2**64 - 1))
"""What a search in a text returns that finds nothing: `std::string::npos`."""
CONSTANTS: Final = {
    "npos": NPOS,
    "M_PI": Number(math.pi, repr(math.pi)),
    "M_PI_2": Number(math.pi / 2, repr(math.pi / 2)),
    "M_PI_4": Number(math.pi / 4, repr(math.pi / 4)),
    "INFINITY": Number(math.inf, repr(math.inf)),
    "NAN": Number(math.nan, repr(math.nan)),
}
"""Constants of the standard library, by their last name."""
_SEARCHES: Final[dict[str, Callable[[str, str], int]]] = {
    "find": str.find,
    "rfind": str.rfind,
    "find_first_of": lambda text, letters: min((at for at, one in enumerate(text) if one in letters), default=-1),
    "find_last_of": lambda text, letters: max((at for at, one in enumerate(text) if one in letters), default=-1),
}
_CUT: Final = "it is cut when the program runs"
_LAST_SLASH: Final = Unknown("it is the place of the last slash in the namespace of the node")
LISTS: Final = frozenset(
    {
        "V_string", "vector", "array", "list", "set", "deque", "initializer_list", "unordered_set", "tuple", "pair",
        "queue",
    }
)  # fmt: skip
MAPS: Final = frozenset({"M_string", "map", "unordered_map", "multimap"})
NUMBERS: Final[frozenset[str]] = frozenset(
    {
        "int", "double", "float", "size_t", "unsigned", "long", "short", "uint8_t", "uint16_t", "uint32_t",
        "uint64_t", "int8_t", "int16_t", "int32_t", "int64_t",
    }
)  # fmt: skip
TYPES: Final = TEXTS | STREAMS | LISTS | MAPS | NUMBERS
_MOST_COPIES: Final = 64
_MAKERS: Final = re.compile(r"make_(?:shared|unique|optional|impl|\w+_impl|\w+_ptr|intrusive\w*)|allocate_shared")
"""Functions that create an object of their template argument, of the standard library and of others like it."""
_SAME: Final = frozenset(
    {
        "move", "forward", "ref", "cref", "as_const", "static_pointer_cast", "dynamic_pointer_cast",
        "const_pointer_cast", "boost_shared_ptr", "to_string_view", "shared_from_this", "decltype", "begin", "cbegin",
    }
)  # fmt: skip
_OWN: Final = frozenset(
    {
        "c_str", "str", "data", "get", "string", "native", "generic_string", "value", "lock", "load", "as_string",
        "as_int", "as_double", "as_bool", "as_string_array", "as_integer_array", "as_double_array", "as_bool_array",
        "get_value", "toStdString", "clone", "front", "readFromRT", "get_parameter_value", "shared_from_this",
    }
)  # fmt: skip
_ADDERS: Final = frozenset(
    {
        "push_back", "emplace_back", "push", "emplace", "insert", "add", "push_front", "insert_or_assign",
        "try_emplace", "emplace_front",
    }
)  # fmt: skip
_CHANGERS: Final = _ADDERS | {"append", "operator+=", "assign", "clear", "erase", "pop_back", "replace", "resize"}
_HOLDERS: Final = frozenset({"optional", "variant", "any"})
"""Templates whose objects hold one object, which `emplace` constructs."""
_CLEARED: Final[dict[type, Value]] = {Sequence: Sequence(()), Mapping: Mapping(()), Text: Text.of("")}
_ENDS: Final = {"front": 0, "back": -1, "top": -1}
_PAIR: Final = 2
_PAIRS: Final = ("pair", "tuple")
_PLAIN: Final = NUMBERS | TEXTS | {"bool"}
_RANGE: Final = 3
"""How many arguments `insert(position, begin, end)` has."""
_MOST_ITEMS: Final = 64
_TO_TEXT: Final = frozenset({"lexical_cast", "str", "value_to_string"})
_FLOATING: Final = frozenset({"double", "float"})
_BITS: Final = {
    "int8_t": 7, "uint8_t": 8, "int16_t": 15, "short": 15, "uint16_t": 16, "int": 31, "int32_t": 31, "uint32_t": 32,
    "unsigned": 32, "long": 63, "int64_t": 63, "uint64_t": 64, "size_t": 64,
}  # fmt: skip
"""The bits of the whole numbers of a type, on a machine with 64 bits, without that of the sign."""
_UNSIGNED: Final = frozenset({"unsigned", "size_t", *(name for name in _BITS if name.startswith("uint"))})
_LARGEST_FLOAT: Final = 3.4028234663852886e38
_DOUBLE: Final = sys.float_info
_LIMITS: Final[dict[str, dict[str, float]]] = {
    "double": {"max": _DOUBLE.max, "lowest": -_DOUBLE.max, "min": _DOUBLE.min, "epsilon": _DOUBLE.epsilon},
    "float": {"max": _LARGEST_FLOAT, "lowest": -_LARGEST_FLOAT, "min": 2.0**-126, "epsilon": 2.0**-23},
}
_NOT_FINITE: Final = {"infinity": math.inf, "quiet_NaN": math.nan, "signaling_NaN": math.nan}
_CHAINED: Final = frozenset({"append", "assign", "insert"})
"""Methods of texts that return the text itself, which the next call of a chain changes: `name.append(a).append(b)`."""
_JOINERS: Final = frozenset({"StrCat", "append_path", "concat"})
_BINDERS: Final = frozenset({"bind", "bind_front", "mem_fn"})
_PACKERS: Final = frozenset({"make_pair", "make_tuple", "tie", "forward_as_tuple"})
_OUTPUT: Final = 2
"""The argument of `removeROSArgs` that receives the arguments that are left."""


def as_constant(value: Value) -> Value:
    """Return a value as read from a constant rather than written in place."""
    if isinstance(value, Text):
        return replace(value, resolution=worse(value.resolution, Resolution.CONSTANT))
    return value


def type_of(value: Value) -> Kind | None:
    """Return the type of a value, for the deduction of template arguments."""
    if isinstance(value, Object):
        return value.kind
    if isinstance(value, Text):
        return Kind(("std", "string"))
    if isinstance(value, (Truth, Guard)):
        return Kind(("bool",))
    if isinstance(value, Number):
        return Kind(("double",) if value.floating else ("int",))
    if isinstance(value, Either):
        return type_of(value.items[0])
    if isinstance(value, Sequence):
        inner = type_of(value.items[0]) if value.items else None
        return Kind(("std", "vector"), (TypeValue(inner),) if inner is not None else ())
    return None


def zero(kind: Kind | None) -> Value | None:
    """Return the value of a variable of namespace scope without one; None if it is not of a number or truth type."""
    if kind is None:
        return None
    if kind.name == "bool":
        return Truth(False)
    return stored(kind, number(0)) if kind.name in NUMBERS else None


def likeness(language: Cpp, kind: Type | None, value: Value, frame: Frame, template: tuple[str, ...]) -> float:
    """Return how well a value fits a parameter of a type: 2 as it is, 1 by a conversion, 0 unknown, -3 not at all."""
    value = alternatives(value)[0]
    if kind is None or (kind.names and kind.names[0] in template):
        return 0.5
    resolved = language.kind_of(kind, frame)
    if resolved is None or resolved.name in ("auto", "T"):
        return 0.5
    name = resolved.name
    if isinstance(value, Text):
        return 2.0 if name in TEXTS or name == "char" else (0.2 if resolved.cls is not None else -1.0)
    if isinstance(value, Number):
        floating = value.floating
        if name in NUMBERS:
            return 2.0 if floating == (name in ("double", "float")) else 1.5
        return 1.0 if name == "bool" else (-2.0 if name in TEXTS else 0.1)
    if isinstance(value, (Truth, Guard)):
        return 2.0 if name == "bool" else (1.0 if name in NUMBERS else -1.0)
    if isinstance(value, (Sequence, Mapping)):
        return 1.5 if name in LISTS or name in MAPS else -0.5
    if isinstance(value, (Closure, Bound)):
        return 1.5 if name in ("function", "CallbackT", "Callback") else -0.5
    if isinstance(value, Object):
        if value.kind.cls is not None and value.kind.cls is resolved.cls:
            return 2.5
        if language.kinds.is_a(value.kind, name):
            nested = zip(reversed(value.kind.names), reversed(resolved.names), strict=False)
            return 2.0 if value.kind.cls is not None or all(own == other for own, other in nested) else 1.0
        return -2.0 if name in TEXTS or name in NUMBERS or name == "bool" else -0.5
    return 0.0


def construct(language: Cpp, kind: Kind, arguments: list[Value], *, listed: bool) -> Value | None:
    """Return a new value of a library type; None for other types."""
    name = kind.name
    if name in TEXTS:
        if arguments:
            return join(*(as_text(item) for item in alternatives(arguments[0])))
        return Text.of("") if listed else UNASSIGNED
    if name in STREAMS:
        return Object(kind, native={"text": as_text(arguments[0]) if arguments else Text.of("")})
    if name == "format" and arguments:
        return Object(kind, native={"format": arguments[0]})
    if name in LISTS or name in MAPS:
        copied = alternatives(arguments[0]) if len(arguments) == 1 else ()
        if len(copied) > 1 and all(isinstance(one, Sequence | Mapping) for one in copied):
            return join(*(language.construct(kind, [one], None, listed=listed) for one in copied))
        return _list(language, kind, arguments, listed=listed) if name in LISTS else _map(language, kind, arguments)
    if name in NUMBERS or name in ("bool", "char", "auto", "byte", "function"):
        if arguments:
            return join(*(stored(kind, item) for item in alternatives(arguments[0])))
        begin = zero(kind) if listed else None
        return begin if begin is not None else Unknown("it is given no value in the code that was run")
    if name in ("thread", "jthread"):
        bound = isinstance(arguments[1:] and arguments[0], Closure | Bound)
        language.escape([bound_call(arguments)] if bound else arguments)
        return Object(kind)
    return None


def stored(kind: Kind, value: Value) -> Value:
    """Return a number as a variable of a type stores it: without its fraction, or with one."""
    if isinstance(value, Enumerator) and value.number is not None and kind.name in NUMBERS:
        return number(value.number, value.parameter)
    if not isinstance(value, Number) or not math.isfinite(value.value):
        return value
    if kind.name in _FLOATING:
        return value if set(value.written) & set(".eE") else replace(value, written=f"{value.whole}.0")
    whole = value.whole
    return Number(whole, str(whole), value.parameter) if kind.name in NUMBERS and value.value != whole else value


def _decimal(value: Value) -> Text:
    """Return the text of `std::to_string`: six digits after the point, and no number in hexadecimal."""
    if not isinstance(value, Number) or not math.isfinite(value.value):
        return as_text(value)
    floating = type_of(value) == Kind(("double",))
    return as_text(replace(value, written=f"{value.value:.6f}" if floating else str(value.whole)))


def _list(language: Cpp, kind: Kind, arguments: list[Value], *, listed: bool) -> Value:
    """Return a new list, set, pair or tuple."""
    first = arguments[0] if arguments else None
    if first is not None and len(arguments) == 1:
        if not listed and isinstance(first, (Sequence, Text, Unknown)):
            return first
        if listed and isinstance(first, Sequence) and kind.name not in _PAIRS:
            inner = kind.arguments[0] if kind.arguments else None
            if not (isinstance(inner, TypeValue) and (inner.kind.name in LISTS or inner.kind.cls is not None)):
                return first
    if first is not None and not listed:
        if len(arguments) == _PAIR and first == COMMAND_LINE:
            return COMMAND_LINE
        if len(arguments) == _PAIR and kind.name not in _PAIRS:
            if isinstance(first, Number) and 0 <= first.value <= _MOST_COPIES:
                return Sequence((arguments[1],) * first.whole)
            return between(first, arguments[1]) if isinstance(first, Sequence) else Sequence((arguments[1],), open=True)
        if isinstance(first, Number) and kind.name == "vector":
            return Sequence((), open=True)
    paired = kind.name in _PAIRS
    return Sequence(tuple(_typed(language, kind, item, at if paired else 0) for at, item in enumerate(arguments)))


def _map(language: Cpp, kind: Kind, items: list[Value]) -> Value:
    """Return a new map."""
    if len(items) == 1:
        first = items[0]
        if isinstance(first, Mapping):
            return first
        if isinstance(first, Sequence) and first.items and all(isinstance(item, Sequence) for item in first.items):
            items = list(first.items)
    pairs = [item.items for item in items if isinstance(item, Sequence) and len(item.items) == _PAIR]
    return Mapping(tuple((pair[0], _typed(language, kind, pair[1], 1)) for pair in pairs))


def _typed(language: Cpp, kind: Kind, item: Value, index: int = 0) -> Value:
    """Return an element in braces as a container with elements of some types holds it."""
    inner = kind.arguments[index] if len(kind.arguments) > index else None
    if not isinstance(inner, TypeValue) or not isinstance(item, Sequence):
        return item
    if inner.kind.cls is not None or inner.kind.name in _PAIRS or (not item.items and inner.kind.name in _PLAIN):
        return language.construct(inner.kind, list(item.items), None, 0, listed=True)
    return item


def call(language: Cpp, names: tuple[str, ...], given: Arguments) -> Value | None:
    """Return the result of a library function; None for other functions."""
    name, values = names[-1], given.values
    if _MAKERS.fullmatch(name):
        return _make_shared(language, names, given)
    if name == "string" and not values:
        return Text.of("")
    if name in ("getenv", "secure_getenv"):
        variable = as_text(values[0]).exact if values else None
        return Unknown("it is read from the environment", label=label_of(variable or "") or None)
    if name in _PACKERS or (name == "value_type" and len(values) == _PAIR):
        return Sequence(tuple(values))
    if names[-2:-1] == ("numeric_limits",):
        return _limit(name, given.template)
    if not values:
        return None
    if name == "sizeof..." and given.frame is not None and isinstance(values[0], Text):
        return packs.count(given.frame, values[0].exact or "")
    if name == "strcmp" and len(values) == _PAIR:
        return over(values, lambda *row: compute("!=", row))
    if name in WITH_ARGUMENT:
        return manipulator(name, values)
    if name in _SAME:
        return values[0] if len(values) == 1 else Pack(tuple(values))
    if name in _BINDERS:
        return bound_call(values)
    if name == "async":
        return _asynchronous(language, values, given)
    if name == "pthread_create" and isinstance(values[2:] and values[2], Closure | Bound):
        language.escape([bound_call(values[2:])])
    if name in ("to_string", "to_wstring"):
        return join(*(_decimal(item) for item in alternatives(values[0])))
    if name in _TO_TEXT:
        return join(*(as_text(item) for item in alternatives(values[0])))
    if name in _JOINERS:
        return concatenate(*values)
    if name in _WRITERS and names[0] in (name, "std") and len(values) > 1 and given.frame is not None:
        put(language.machine, given.written[0], _WRITERS[name](values), given.frame)
        return Unknown("it is a number of letters")
    if name in ("format", "sprintf"):
        if names[0] == "boost" or (len(values) == 1 and len(names) == 1):
            return Object(Kind(("boost", "format")), native={"format": values[0]})
        return formatted(values[0], values[1:])
    if name in ("get", "get_if", "any_cast"):
        return _got(values[0], given.template)
    if name == "visit" and len(values) == _PAIR:
        results = (
            language.calls.value(values[0], Arguments([one], frame=given.frame)) for one in alternatives(values[1])
        )
        return join(*results)
    if name == "for_each":
        for one in elements(alternatives(values[0])[0]):
            if isinstance(values[-1], (Closure, Bound)):
                language.calls.value(values[-1], Arguments([one], frame=given.frame))
        return Unknown("it returns what it was given")
    if name == "call_once" and len(values) > 1:
        called = bound_call(values[1:]) if len(values) > _PAIR else values[1]
        return language.calls.value(called, Arguments([], frame=given.frame))
    if name in tokens.CASES:
        return over((values[0],), partial(_cased, change=tokens.CASES[name]))
    if name in ("min", "max"):
        numbers = [value.value for value in values if isinstance(value, Number)]
        return number(min(numbers) if name == "min" else max(numbers)) if len(numbers) == len(values) else None
    result = tokens.call(language, names, given)
    return result if result is not None else _command_line(language, name, given)


_WRITERS: Final[dict[str, Callable[[list[Value]], Value]]] = {
    "sprintf": lambda values: formatted(values[1], values[2:]),
    "snprintf": lambda values: formatted(values[2], values[3:]) if values[2:] else values[1],
    "strcpy": lambda values: values[1],
    "strncpy": lambda values: values[1],
    "strcat": lambda values: concatenate(values[0], values[1]),
}
"""Functions of C that write a text into their first argument: how each makes the text from all its arguments."""


def _cased(value: Value, change: Callable[[str], str]) -> Value:
    """Return a text in capital or small letters; what is not known of it stays."""
    if not isinstance(value, Text):
        return as_text(value)
    return replace(value, parts=tuple(change(part) if isinstance(part, str) else part for part in value.parts))


def _limit(name: str, template: tuple[Value, ...]) -> Number | None:
    """Return a limit of a type of numbers: `std::numeric_limits<T>::max()`; None for other types."""
    of = template[0].kind.name if template and isinstance(template[0], TypeValue) else ""
    if of in _FLOATING:
        value = _LIMITS[of].get(name, _NOT_FINITE.get(name))
        return Number(value, repr(value)) if value is not None else None
    if of not in _BITS or name not in ("max", "min", "lowest"):
        return None
    if name == "max":
        return number(2 ** _BITS[of] - 1)
    return number(0 if of in _UNSIGNED else -(2 ** _BITS[of]))


def _make_shared(language: Cpp, names: tuple[str, ...], given: Arguments) -> Value | None:
    """Return the object of `make_shared<T>()` or `T::make_shared()`."""
    of = given.template[0] if given.template else None
    if isinstance(of, TypeValue):
        values = given.values[1:] if names[-1] == "allocate_shared" else given.values
        return _on_heap(language.construct(of.kind, values, given.frame, given.line))
    if names[-1] == "make_shared" and len(names) > 1 and given.frame is not None:
        outer = language.kind(form.Type(names[:-1]), given.frame)
        if isinstance(outer, Kind):
            return _on_heap(language.construct(outer, given.values, given.frame, given.line))
    return None


def _on_heap(value: Value) -> Value:
    if isinstance(value, Object):
        value.heap = True
    return value


def _got(of: Value, template: tuple[Value, ...]) -> Value | None:
    """Return the result of `std::get<index>()` of a tuple, or of `std::get<type>()` of a variant."""
    wanted = template[0] if template else None
    if isinstance(wanted, TypeValue):
        cls = pointee(wanted.kind).cls
        held = [one for one in alternatives(of) if isinstance(one, Object) and one.kind.cls is cls]
        return join(*held) if held and cls is not None else None
    if not isinstance(wanted, Number) or not isinstance(of, Sequence):
        return None
    return of.items[wanted.whole] if wanted.value < len(of.items) else Unknown("the element does not exist")


def _command_line(language: Cpp, name: str, given: Arguments) -> Value | None:
    """Return the arguments of the program without those for ROS."""
    if name in ("remove_ros_arguments", "init_and_remove_ros_arguments") and len(given.values) > 1:
        return given.values[1]
    if name == "removeROSArgs" and len(given.values) > _OUTPUT and given.frame is not None:
        put(language.machine, given.written[_OUTPUT], given.values[1], given.frame)
        return Unknown("it returns nothing")
    return None


def _asynchronous(language: Cpp, values: list[Value], given: Arguments) -> Value | None:
    """Return the result of a function that `std::async` runs, which its future gives."""
    called = next((one for one in values if isinstance(one, Closure | Bound)), None)
    if called is None:
        return None
    rest = values[values.index(called) + 1 :]
    owner = called.of if isinstance(called, Bound) else None
    if isinstance(called, Bound) and isinstance(owner, Kind):
        methods = language.methods(owner, called.name)
        if all(len(one.parameters) != len(rest) for one, _ in methods):  # the first argument is the object
            return language.calls.value(bound_call([called, *rest]), Arguments([], frame=given.frame))
    return language.calls.value(called, Arguments(rest, frame=given.frame))


def method(language: Cpp, of: Value, name: str, given: Arguments, written: Expression | None) -> Value | None:
    """Return the result of a method of a string, a container or a pointer; None for other methods."""
    frame, values = given.frame, given.values
    if name == "emplace" and written is not None and frame is not None:
        emplaced = _emplace(language, given, written, frame)
        if emplaced is not None:
            language.machine.assign(written, emplaced, frame)
            return emplaced
    if isinstance(of, Object):
        return _of_object(language, of, name, given, written)
    if "emplace" in name and written is not None and frame is not None:
        values = _emplaced(language, given, written, frame)
    if name in _ADDERS and frame is not None and len(given.written) == len(values):
        pairs = zip(values, given.written, strict=True)
        values = [language.copies.copy(value, None, frame, one, frame) for value, one in pairs]
    change = _changed(of, name, values)
    if change is not None and written is not None and frame is not None:
        language.machine.assign(_start_of_chain(written), change, frame)
        return change if name in _CHAINED or name == "reset" else Unknown("it returns nothing")
    if name in _ENDS and isinstance(of, Sequence):
        return of.items[_ENDS[name]] if of.items else Unknown("the list is empty")
    if name in _OWN:
        language.machine.framework.converted(of, name, given.template)
        return of
    if name in ("at", "operator[]") and values:
        return element(of, values[0])
    if name in ("size", "length") and isinstance(of, (Sequence, Mapping)) and not of.open:
        if isinstance(of, Sequence) and of.repeated:
            return LENGTH
        if is_unset(of):
            return Unknown("it depends on a parameter", of.parameter)
        return number(float(len(of.items)), None if language.machine.counting else of.parameter)
    if name == "empty" and not isinstance(of, Unknown):
        return _empty(of)
    if name in ("find", "count", "contains") and isinstance(of, (Mapping, Sequence)) and values:
        entry = element(of, values[0]) if name == "find" and isinstance(of, Mapping) else Unknown("it is searched")
        return Unknown("it is searched") if isinstance(entry, Unknown) else Sequence((values[0], entry))
    if name == "substr" and isinstance(of, Text):
        return _slice(of, values)
    if name in ("rfind", "find_last_of") and values == [Text.of("/")] and _is_namespace(of):
        return _LAST_SLASH
    if name in ("begin", "cbegin", "end", "cend") and isinstance(of, (Sequence, Mapping)):
        return moved(of, name, values)
    if name == "value_or" and values:
        return of if not isinstance(of, Unknown) else values[0]
    return _of_text(of, name, values) if isinstance(of, Text) else None


def _start_of_chain(written: Expression) -> Expression:
    """Return what calls of methods in a row change: `name` in `name.append(a).append(b)`."""
    while isinstance(written, form.Call) and isinstance(written.function, form.Member):
        if written.function.name not in _CHAINED:
            break
        written = written.function.of
    return written


def _of_object(language: Cpp, of: Object, name: str, given: Arguments, written: Expression | None) -> Value | None:
    """Return the result of a method of a stream, a format or a pointer."""
    if of.kind.name in STREAMS:
        if name != "str":
            return Unknown("it is computed")
        if given.values:
            language.machine.write(of.native, "text", as_text(given.values[0]))
        return read_back(of.native.get("text", Text.of("")))
    if "format" in of.native and name == "str":
        return formatted(of.native["format"], [])
    if name in ("get", "lock", "value", "load", "shared_from_this", "release", "clone", "operator->"):
        return of
    if name == "reset" and given.values and written is not None and given.frame is not None:
        language.machine.assign(written, given.values[0], given.frame)
        return given.values[0]
    return None


def _emplace(language: Cpp, given: Arguments, written: Expression, frame: Frame) -> Value | None:
    """Return the object that `emplace` constructs in an optional, a variant or an `any`; None for other types."""
    declared = language.kinds.written_type(written, frame) if isinstance(written, (form.Name, form.Member)) else None
    holder = language.kinds.variable_kind(*declared) if declared is not None else None
    if holder is None or holder.name not in _HOLDERS:
        return None
    inner = next(iter(given.template or holder.arguments), None)
    return language.construct(inner.kind, given.values, frame, given.line) if isinstance(inner, TypeValue) else None


def _emplaced(language: Cpp, given: Arguments, written: Expression, frame: Frame) -> list[Value]:
    """Return the element that `emplace` constructs in a container, behind its key."""
    declared = language.type_of(written, frame)
    inner = declared.arguments[-1] if declared is not None and declared.arguments else None
    keys = given.values[:1] if declared is not None and declared.name in MAPS else []
    if isinstance(inner, TypeValue) and inner.kind.name in ("pair", "tuple") and len(given.values) > 1:
        return [*keys, Sequence(tuple(given.values[len(keys) :]))]
    if not isinstance(inner, TypeValue) or inner.kind.cls is None:
        return given.values
    return [*keys, language.construct(inner.kind, given.values[len(keys) :], frame, given.line)]


def changes(of: Either, name: str) -> bool:
    """Return whether a method changes a container or a text, whichever of some it is."""
    return name in _CHANGERS and all(isinstance(one, Sequence | Mapping | Text) for one in of.items)


def _changed(of: Value, name: str, values: list[Value]) -> Value | None:
    """Return a container or a text after a method changed it; None for other methods."""
    if isinstance(of, Either):
        changed = [_changed(one, name, values) for one in of.items]
        return join(*(one for one in changed if one is not None)) if None not in changed else None
    if name in ("insert", "push_back") and isinstance(of, Text) and not of.wholly_unknown and values:
        return _inserted(of, values) if name == "insert" else concatenate(of, values[0])
    if name in _ADDERS:
        return _added(of, name, values)
    if name in ("append", "operator+=") and isinstance(of, Text):
        return concatenate(of, *values[:1])
    if name == "assign" and values:
        return values[0]
    if name == "clear" and type(of) in _CLEARED:
        return _CLEARED[type(of)]
    if name == "reset":
        return values[0] if values else Unknown("it is null")
    if name in ("initRT", "writeFromNonRT", "store", "set") and len(values) == 1 and isinstance(of, Unknown):
        return values[0]
    if name == "pop_back" and isinstance(of, Sequence) and not of.open:
        return replace(of, items=of.items[:-1])
    if name == "resize" and isinstance(of, Sequence):
        return _resized(of, values)
    if name == "erase" and isinstance(of, (Sequence, Mapping)):
        return replace(of, open=True)
    if name in ("erase", "pop_back", "replace", "resize") and isinstance(of, Text):
        return of if name == "erase" and _of_node(of) else Text.hole(_CUT, parameter=of.parameter)
    return None


def _inserted(of: Text, values: list[Value]) -> Value:
    """Return a text with another inserted: at its start, or at a known place of a known text."""
    place, more = values[0], values[-1]
    if not isinstance(place, Number) or len(values) != _PAIR:
        return Text.hole(_CUT, parameter=of.parameter)
    if place.value == 0:
        return concatenate(more, of)
    if of.exact is None:
        return Text.hole(_CUT, parameter=of.parameter)
    at = place.whole
    return concatenate(replace(of, parts=(of.exact[:at],)), more, replace(of, parts=(of.exact[at:],)))


def _resized(of: Sequence, values: list[Value]) -> Sequence:
    """Return a list with as many elements as `resize` says: those that are new have the value given, if any."""
    given = values[0].value if values and isinstance(values[0], Number) else -1
    if not 0 <= given <= _MOST_ITEMS:
        return replace(of, repeated=True)
    count = int(given)
    new = values[1] if len(values) > 1 else Unknown("it is given no value in the code that was run")
    return replace(of, items=(*of.items[:count], *(new for _ in range(count - len(of.items)))))


def _added(of: Value, name: str, values: list[Value]) -> Value | None:
    """Return a container with an element added."""
    if isinstance(of, Mapping):
        pair = values
        if len(values) == 1 and isinstance(values[0], Sequence):
            pair = list(values[0].items)
        return with_element(of, *pair[:_PAIR]) if len(pair) == _PAIR else replace(of, open=True)
    if isinstance(of, Sequence):
        if name == "insert" and len(values) == _RANGE and isinstance(values[1], Sequence):
            return replace(of, items=(*of.items, *values[1].items))
        if not values or len(of.items) >= _MOST_ITEMS:
            return replace(of, open=True)
        if name.startswith("emplace") and len(values) > 1:
            return replace(of, items=(*of.items, Unknown("it is of a class that is not in the build")))
        return replace(of, items=(*of.items, values[-1]))
    if isinstance(of, Unknown) and of.parameter is None and name in ("push_back", "emplace_back") and values:
        return Sequence((values[-1],), open=True)
    return None


def _empty(of: Value) -> Value:
    if isinstance(of, (Sequence, Mapping)):
        if of.parameter is not None or of.open:
            return Unknown("it depends on a parameter", of.parameter)
        if isinstance(of, Sequence) and of.repeated and not of.items:
            return LENGTH
        return Truth(not of.items)
    if isinstance(of, Text):
        if of.parameter is not None and of.parameter.endswith("[]") and of.exact != "":
            return Truth(False)  # a list of names has no empty ones
        if of.parameter is not None:
            return Guard((f"!{of.parameter}",))
        if of.given_name or any(isinstance(part, str) and part for part in of.parts):
            return Truth(False)
        return Truth(True) if of.exact == "" and not of.unsure else Unknown("it is not known")
    return Unknown("it is not known")


def _of_text(of: Text, name: str, values: list[Value]) -> Value | None:
    """Return the result of a method that looks into a text; None for other methods, or if it is not known."""
    if name == "compare" and len(values) == 1:
        same = compute("==", (of, values[0]))
        if isinstance(same, Guard):
            return negate(same)
        return number(float(not same.value)) if isinstance(same, Truth) else None
    if name in ("size", "length") and of.exact is not None and of.parameter is None and not of.unsure:
        return number(float(len(of.exact)))
    given = values[0].exact if len(values) == 1 and isinstance(values[0], Text) and not values[0].parameter else None
    if name not in _SEARCHES or given is None or of.parameter is not None or of.unsure:
        return None
    first = of.parts[0]
    if of.exact is None:
        begins = isinstance(first, str) and first.startswith(given)
        return number(0) if name == "find" and begins else None
    index = _SEARCHES[name](of.exact, given)
    return NPOS if index < 0 else number(float(index))


def _of_node(text: Text) -> bool:
    """Check whether a text begins with the name or namespace of the node, of which programs cut the first slash."""
    return text.parts[0] in (NODE_NAME, OWN_NAMESPACE)


def _is_namespace(of: Value) -> bool:
    return isinstance(of, Text) and of.parts == (OWN_NAMESPACE,)


def _slice(text: Text, bounds: list[Value]) -> Value:
    if bounds == [number(0), _LAST_SLASH] and _is_namespace(text):
        return Text((PARENT_NAMESPACE,))
    numbers = [bound.whole for bound in bounds if isinstance(bound, Number)]
    if numbers == [1] and _of_node(text):
        return text
    if text.exact is None or len(numbers) != len(bounds) or not numbers:
        return Text.hole(_CUT, parameter=text.parameter)
    end = numbers[0] + numbers[1] if len(numbers) > 1 else None
    return replace(text, parts=(text.exact[numbers[0] : end],))
