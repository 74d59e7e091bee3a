"""Types and functions of Python itself, `os.path`, `argparse` and their like, over abstract values."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Final, cast

from kg.extract.python import paths, texts
from kg.extract.python.functions import FUNCTIONS, NAMED, countable, elements, from_environment, is_open
from kg.facts import Resolution
from kg.holes import Hole, label_of
from kg.symbolic import containers
from kg.symbolic.containers import COMMAND_LINE, is_unknown_parameter, is_unset, key_of, part_of, with_element
from kg.symbolic.durations import INFINITE, duration
from kg.symbolic.messages import GENERATED
from kg.symbolic.operators import NULL
from kg.symbolic.parameters import type_of_value, with_parameter
from kg.symbolic.state import Alias, Arguments
from kg.symbolic.values import (
    ABSENT,
    Bound,
    Closure,
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
    alternatives,
    combinations,
    join,
    number,
    over,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.python.language import Python
    from kg.extract.python.modules import PythonUnit
    from kg.symbolic.form import Expression

_COMPUTED: Final = Unknown("it is computed when the program runs")
_NOTHING: Final = NULL
_MOST_ITEMS: Final = 5_000
"""How many items of a range are known, and how many calls add to a list."""
_SAME: Final = frozenset({"get_parameter_value", "copy", "to_msg", "get_type_hash"})
_VALUES: Final = frozenset({"value", *(f"{kind}_value" for kind in ("string", "integer", "double", "bool"))}) | {
    f"{kind}_array_value" for kind in ("string", "integer", "double", "bool")
}
"""Members of a parameter, or of an enumerator, that are its value."""
_TYPES: Final = (
    "bool",
    "int",
    "double",
    "string",
    "byte_array",
    "bool_array",
    "int_array",
    "double_array",
    "string_array",
)
_TYPE_NUMBERS: Final[dict[str | None, int]] = {name: at for at, name in enumerate(_TYPES, 1)}
"""The `type` of a rcl_interfaces/ParameterValue."""
CONSTANTS: Final[dict[str, Value]] = {
    "sys.argv": COMMAND_LINE,
    "os.sep": Text.of("/"),
    "os.path.sep": Text.of("/"),
    "os.pathsep": Text.of(":"),
    "os.linesep": Text.of("\n"),
    **{f"math.{name}": number(getattr(math, name)) for name in ("pi", "tau", "e", "inf", "nan")},
    "rclpy.duration.Infinite": duration(INFINITE),
    **{
        f"diagnostic_updater.{name}": TypeValue(Kind(("diagnostic_msgs", "msg", name)))
        for name in ("DiagnosticArray", "DiagnosticStatus", "KeyValue")
    },
}


# Elements


def element(of: Value, key: Value) -> Value:
    """Return the element of a container at a key."""
    if isinstance(of, Object):
        return Unknown("it is an element of an object")
    if isinstance(of, TypeValue) and of.kind.names == ("os", "environ"):
        return from_environment(key)
    if isinstance(of, Sequence | Text) and isinstance(key, Number) and key.value < 0 and not is_unset(of):
        items = elements(of) if not isinstance(of, Text) or of.exact is not None else []
        count = -key.whole
        return items[-count] if len(items) >= count and not is_open(of) else Unknown("it is one of the last elements")
    if isinstance(of, Text) and of.exact is not None and isinstance(key, Number) and key.value < len(of.exact):
        return replace(of, parts=(of.exact[key.whole],))
    return containers.element(of, key)


def member(of: Value, name: str) -> Value | None:
    """Return a member of a parameter, an enumerator, a number, a path, or a map with keys as members; else None."""
    for key, value in of.items if isinstance(of, Mapping) else ():
        if isinstance(key, Text) and key.exact == name:
            return value
    if name in _VALUES:
        return of
    if name == "type" and (of_type := type_of_value(of)) in _TYPE_NUMBERS:
        return number(_TYPE_NUMBERS[of_type])
    return paths.MEMBERS[name](of) if isinstance(of, Text) and name in paths.MEMBERS else None


# Functions


def call(language: Python, names: tuple[str, ...], given: Arguments) -> Value | None:
    """Return the result of a function outside of the sources, by its full name; None for other functions."""
    path = ".".join(names)
    apply, named = FUNCTIONS.get(path), NAMED.get(path)
    if apply is not None:
        return language.machine.over(given.values, lambda *row: apply(list(row)))
    if named is not None:
        return language.machine.over(given.values, lambda *row: named(list(row), given.named))
    special = _SPECIAL.get(path)
    return special(language, given) if special is not None else None


def _imported(language: Python, given: Arguments) -> Value | None:
    """`importlib.import_module("package.module")`, and `uvicorn.run("package.module:app")`."""
    name = given.values[0].exact if given.values and isinstance(given.values[0], Text) else None
    if name is None or name.startswith(".") or given.frame is None:
        return None
    unit = cast("PythonUnit", given.frame.unit)
    return language.imported(name.partition(":")[0].split("."), unit, lazy=False)


def _attribute(language: Python, given: Arguments) -> Value:
    """`getattr(value, name, default)`."""
    if len(given.values) < 2:  # noqa: PLR2004 - the value and the name
        return _COMPUTED
    members = [
        _of_parameter(language.member_named(of, name), name) if isinstance(name, Text) else _COMPUTED
        for of, name in combinations(given.values[:2])
    ]
    if isinstance(given.values[0], Unknown):
        return _COMPUTED
    missing = all(isinstance(one, Unknown) for one in members)
    return given.values[2] if missing and len(given.values) > 2 else join(*members)  # noqa: PLR2004 - the default


def _of_parameter(member: Value, name: Text) -> Value:
    """Return a member, unless it is a type of messages that a parameter names, as launch files set it to others."""
    if name.parameter is None or not isinstance(member, TypeValue) or GENERATED.isdisjoint(member.kind.names[:-1]):
        return member
    return Unknown("it depends on a parameter", name.parameter)


def _set_attribute(language: Python, given: Arguments) -> Value:
    """`setattr(object, name, value)`."""
    of, name, value = (*given.values, *[_COMPUTED] * 3)[:3]
    for one in alternatives(of):
        if isinstance(one, Object) and isinstance(name, Text) and name.exact:
            language.machine.write(one.fields, name.exact, value)
    return _NOTHING


def _partial(given: Arguments) -> Value:
    """`functools.partial(function, ...)`."""
    first = given.values[0] if given.values else _COMPUTED
    if isinstance(first, Bound | TypeValue):
        named = Mapping(tuple((Text.of(name), value) for name, value in given.named.items()))
        return Object(_PARTIAL, native={"called": first, "values": Sequence(tuple(given.values[1:])), "named": named})
    if not isinstance(first, Closure):
        return first
    return replace(first, bound=(*first.bound, *given.values[1:]), named=(*first.named, *given.named.items()))


def _named_tuple(given: Arguments) -> Value:
    """`collections.namedtuple(name, fields)`: a class whose objects have these fields."""
    fields = given.values[1] if len(given.values) > 1 else None
    if isinstance(fields, Text) and fields.exact is not None:
        fields = Sequence(tuple(Text.of(name) for name in fields.exact.replace(",", " ").split()))
    return Object(_NAMED_TUPLE, native={"fields": fields}) if isinstance(fields, Sequence) else _COMPUTED


def called(language: Python, of: Object, given: Arguments) -> Value | None:
    """Return the result of a call of a partial function or of a class of named tuples; None for other objects."""
    native = of.native
    if of.kind == _PARTIAL and isinstance(native["values"], Sequence) and isinstance(native["named"], Mapping):
        bound = {key.exact or "": value for key, value in native["named"].items if isinstance(key, Text)}
        values = [*native["values"].items, *given.values]
        return language.calls.value(native["called"], replace(given, values=values, named={**bound, **given.named}))
    if of.kind == _NAMED_TUPLE and isinstance(native["fields"], Sequence):
        names = [name.exact or "" for name in native["fields"].items if isinstance(name, Text)]
        return Object(_TUPLE, fields={**dict(zip(names, given.values, strict=False)), **given.named})
    return None


_PARTIAL: Final = Kind(("functools", "partial"))
_NAMED_TUPLE: Final = Kind(("collections", "namedtuple"))
_TUPLE: Final = Kind(("collections", "tuple"))


def _mapped(language: Python, given: Arguments) -> Value:
    """`map(function, items)`."""
    items = countable(given.values[1]) if len(given.values) > 1 else None
    if items is None:
        language.escape(given.values)
        return _COMPUTED
    called = [replace(given, values=[item], named={}) for item in items]
    return Sequence(tuple(language.calls.value(given.values[0], one) for one in called))


def _next(given: Arguments) -> Value:
    """`next(iterator, default)`."""
    items = [*(elements(given.values[0]) if given.values else []), *given.values[1:]]
    return items[0] if items else _COMPUTED


def _is_instance(given: Arguments) -> Value:
    """`isinstance(value, class)`, as far as the classes are those of texts, numbers and collections."""
    of, kinds = (*given.values, _COMPUTED, _COMPUTED)[:2]
    names = {
        kind.kind.name
        for kind in (kinds.items if isinstance(kinds, Sequence) else (kinds,))
        if isinstance(kind, TypeValue)
    }
    own = next((own for cls, own in _CLASSES.items() if isinstance(of, cls)), None)
    if own is None or not names or getattr(of, "parameter", None) is not None:
        return _COMPUTED
    return Truth(bool(own & names))


_CLASSES: Final = {
    Text: {"str", "basestring", "unicode", "string_types"},
    Number: {"int", "float", "long", "Number"},
    Truth: {"bool", "int"},
    Sequence: {"list", "tuple", "set", "Iterable", "Sequence"},
    Mapping: {"dict", "OrderedDict", "Mapping"},
}


def _globals(given: Arguments) -> Value:
    """`globals()`: the module as a mapping."""
    return Mapping(tuple((Text.of(name), value) for name, value in _module(given).items()))


def _locals(given: Arguments) -> Value:
    """`locals()`: the variables of the function that makes a call as a mapping."""
    values = {} if given.frame is None else given.frame.variables
    return Mapping(tuple((Text.of(name), one) for name, one in values.items() if not isinstance(one, Alias)))


def _module(given: Arguments) -> dict[str, Value]:
    """Return the variables of the module that makes a call."""
    if given.frame is None:
        return {}
    *_, module = given.frame.outward()
    return {name: value for name, value in module.variables.items() if not isinstance(value, Alias)}


def _field(language: Python, given: Arguments) -> Value:
    """`dataclasses.field(default=1)` or `field(default_factory=list)`: the value that the field has by default."""
    factory = given.named.get("default_factory", given.named.get("factory"))
    if factory is not None:
        return language.calls.value(factory, replace(given, values=[], named={}))
    return given.named.get("default", next(iter(given.values), _COMPUTED))


def _tests(language: Python, given: Arguments) -> Value:
    """`unittest.main()`: runs the test cases of the module."""
    module = _module(given)
    for value in module.values():
        if isinstance(value, TypeValue) and any(base.name == "TestCase" for base in language.chain(value.kind)[1]):
            language.create(value)
    return _NOTHING


def _preset(language: Python, given: Arguments) -> Value:
    """`QoSPresetProfiles.get_from_short_key("sensor_data")`."""
    name = given.values[0].exact if given.values and isinstance(given.values[0], Text) else None
    return language.member(TypeValue(Kind(("rclpy", "qos", "QoSPresetProfiles"))), name) if name else _COMPUTED


_SPECIAL: Final[dict[str, Callable[[Python, Arguments], Value | None]]] = {
    "builtins.getattr": _attribute,
    "importlib.import_module": _imported,
    "uvicorn.run": _imported,
    "builtins.setattr": _set_attribute,
    "builtins.map": _mapped,
    "builtins.next": lambda _, given: _next(given),
    "builtins.isinstance": lambda _, given: _is_instance(given),
    **dict.fromkeys(("builtins.globals", "builtins.vars"), lambda _, given: _globals(given)),
    "builtins.locals": lambda _, given: _locals(given),
    **dict.fromkeys(("dataclasses.field", "attr.ib", "attr.field", "attrs.field", "pydantic.Field"), _field),
    "functools.partial": lambda _, given: _partial(given),
    "collections.namedtuple": lambda _, given: _named_tuple(given),
    "functools.wraps": lambda _, given: _COMPUTED,  # noqa: ARG005 - it calls none of its arguments
    "unittest.main": _tests,
    "rclpy.qos.QoSPresetProfiles.get_from_short_key": _preset,
}


# Methods


def method(language: Python, of: Value, name: str, given: Arguments, written: Expression | None) -> Value | None:
    """Return the result of a method of a text, a container or a parameter; None for other methods."""
    values = given.values
    if name in _SAME:
        return of
    if isinstance(of, Sequence | Mapping):
        changed = _changed(of, name, values, given)
        if changed is not None and written is not None and given.frame is not None:
            language.machine.assign(written, changed, given.frame)
            return _popped(of, name, values)
    if name == "<slice>":
        return _slice(of, values)
    if name in ("items", "iteritems", "viewitems", "keys", "iterkeys", "values", "itervalues"):
        return _view(of, name)
    if name == "get" and values:
        return _got(of, values, given)
    if isinstance(of, Text):
        if name in paths.METHODS:
            return paths.METHODS[name](of, values)
        if name == "format":
            return texts.braces(of, values, given.named)
        if name in ("startswith", "endswith") and len(values) == 1:
            return _begins(of, name, values[0])
        return over(values, lambda *row: texts.method(of, name, list(row)) or _COMPUTED)
    return None


def _changed(of: Sequence | Mapping, name: str, values: list[Value], given: Arguments) -> Value | None:
    """Return a container after a method changed it; None for other methods."""
    if name == "clear":
        return Mapping(()) if isinstance(of, Mapping) else Sequence(())
    if isinstance(of, Mapping):
        if name == "update":
            merged = of
            pairs = [pair for one in values if isinstance(one, Mapping) for pair in one.items]
            pairs += [(Text.of(key), value) for key, value in given.named.items()]
            for key, value in pairs:
                changed = with_element(merged, key, value)
                merged = changed if isinstance(changed, Mapping) else merged
            return merged
        if name == "setdefault" and values and all(key != values[0] for key, _ in of.items):
            return with_element(of, values[0], values[1] if len(values) > 1 else NULL)
        if name == "pop" and values:
            return replace(of, items=tuple(pair for pair in of.items if pair[0] != values[0]))
        return of if name == "setdefault" else None
    if name in ("append", "add", "appendleft", "put") and values:
        return replace(of, items=(*of.items, values[0])) if len(of.items) < _MOST_ITEMS else replace(of, open=True)
    if name == "insert" and len(values) > 1:
        at = values[0].whole if isinstance(values[0], Number) else 0
        return replace(of, items=(*of.items[:at], values[1], *of.items[at:]))
    if name == "reverse":
        return replace(of, items=of.items[::-1])
    if name == "pop":
        popped = element(of, values[0] if values else number(-1))
        at = next((index for index, one in enumerate(of.items) if one is popped), len(of.items))
        return replace(of, items=(*of.items[:at], *of.items[at + 1 :]))
    if name in ("extend", "update") and values:
        more = values[0]
        closed = isinstance(more, Sequence) and not more.open
        return replace(of, items=(*of.items, *elements(more)), open=of.open or not closed)
    return of if name in ("sort", "remove", "discard", "popleft") else None


def _popped(of: Sequence | Mapping, name: str, values: list[Value]) -> Value:
    """Return what a method that changes a container gives."""
    if isinstance(of, Mapping):
        if name == "pop" and values:
            return _got(of, values, None) or _COMPUTED
        if name == "setdefault" and values:
            entry = next((value for key, value in of.items if key == values[0]), None)
            return entry if entry is not None else next(iter(values[1:]), NULL)
        return _NOTHING
    if name == "pop":
        return element(of, values[0] if values else number(-1))
    return join(*of.items) if name == "popleft" and of.items else _NOTHING


def _view(of: Value, name: str) -> Value | None:
    """Return the keys, the values or the pairs of a mapping."""
    kind = name.removeprefix("iter").removeprefix("view")
    if isinstance(of, Object | TypeValue):
        return None
    if is_unknown_parameter(of) or (isinstance(of, Sequence | Mapping) and not of.items and of.parameter):
        parameter: str = getattr(of, "parameter", None) or ""
        parts: dict[str, Value] = {"keys": key_of(parameter), "values": part_of(f"{parameter}[]")}
        return Sequence((parts[kind],) if kind in parts else (Sequence((parts["keys"], parts["values"])),))
    if not isinstance(of, Mapping):
        return None
    rows: dict[str, tuple[Value, ...]] = {
        "keys": tuple(key for key, _ in of.items),
        "values": tuple(value for _, value in of.items),
        "items": tuple(Sequence(pair) for pair in of.items),
    }
    return Sequence(rows[kind], of.open)


def _got(of: Value, values: list[Value], given: Arguments | None) -> Value | None:
    """Return what `mapping.get(key, default)` gives."""
    default = given.named.get("default") if given is not None else None
    if default is None:
        default = values[1] if len(values) > 1 else NULL
    if isinstance(of, Mapping) and (of.items or of.parameter is None):
        entry = element(of, values[0])
        return default if isinstance(entry, Unknown) and entry.parameter is None else entry
    if is_unknown_parameter(of) or isinstance(of, Mapping | Sequence):
        part = element(of, values[0])
        name: str | None = getattr(part, "parameter", None)
        return with_parameter(default, name) if name is not None and not isinstance(default, Unknown) else part
    return None


def _begins(of: Text, name: str, value: Value) -> Value:
    given = value.exact if isinstance(value, Text) else None
    part = of.parts[0 if name == "startswith" else -1] if of.parts else ""
    if given is None or of.parameter is not None or not isinstance(part, str):
        return Unknown("it depends on a value", of.parameter)
    if of.exact is None and len(part) < len(given):
        return Unknown("it depends on a value")
    return Truth(part.startswith(given) if name == "startswith" else part.endswith(given))


def _slice(of: Value, bounds: list[Value]) -> Value | None:
    """Return `of[start:stop:step]`."""
    numbers = [one.whole if isinstance(one, Number) else None for one in bounds]
    constant = all(isinstance(one, Number) or one == NULL for one in bounds)
    if isinstance(of, Sequence) and of.parameter == "argv":
        return of
    if isinstance(of, Text):
        if of.exact is None or not constant:
            return Text.hole("it is cut when the program runs", parameter=of.parameter)
        return replace(of, parts=(of.exact[slice(*numbers)],))
    if isinstance(of, Sequence) and constant and numbers[2] != 0:
        return replace(of, items=of.items[slice(*numbers)])
    return of if isinstance(of, Sequence) or is_unknown_parameter(of) else None


# Parsers of the command line


def object_method(language: Python, of: Object, name: str, given: Arguments) -> Value | None:
    """Return the result of a method of a parser of the command line; None for other methods."""
    if of.kind.name not in ("ArgumentParser", "OptionParser"):
        return None
    if name in ("add_argument", "add_option"):
        option = _option(given)
        options = of.native.get("options", Mapping(()))
        if option is not None:
            language.machine.write(of.native, "options", with_element(options, *option))
        return _NOTHING
    if name in (
        "add_argument_group",
        "add_mutually_exclusive_group",
        "add_option_group",
        "add_subparsers",
        "add_parser",
    ):
        return of
    if name in ("parse_args", "parse_known_args", "parse_intermixed_args"):
        declared = of.native.get("options")
        pairs = declared.items if isinstance(declared, Mapping) else ()
        fields = {key.exact: value for key, value in pairs if isinstance(key, Text) and key.exact}
        namespace = Object(Kind(("argparse", "Namespace")), fields=fields)
        both = name == "parse_known_args" or of.kind.name == "OptionParser"
        return Sequence((namespace, COMMAND_LINE)) if both else namespace
    return None


def _option(given: Arguments) -> tuple[Value, Value] | None:
    """Return the name and the value of an option of the command line."""
    flags = [value.exact for value in given.values if isinstance(value, Text) and value.exact]
    target = given.named.get("dest")
    long = [flag for flag in flags if flag.startswith("--")] or flags[:1]
    name = long[0].lstrip("-").replace("-", "_") if long else None
    if isinstance(target, Text):
        name = target.exact
    if not name:
        return None
    single = bool(flags) and flags[0].startswith("-") and not {"nargs", "action"} & given.named.keys()
    parameter = f"argv[{'|'.join(flags)}]" if single else None
    default = given.named.get("default", ABSENT)
    if isinstance(default, Text):
        value: Value = replace(default, resolution=Resolution.LAUNCH_ARGUMENT, parameter=parameter)
    elif isinstance(default, Number | Sequence | Mapping):
        value = replace(default, parameter=parameter) if isinstance(default, Number) else default
    elif given.named.get("action") is not None:
        value = Unknown("it is given on the command line", label=label_of(name))
    else:
        shown = f"it is the option {parameter} of the command line" if parameter else "it is given on the command line"
        value = Text((Hole(label_of(parameter or name)),), Resolution.LAUNCH_ARGUMENT, parameter, shown)
    return Text.of(name), value
