"""Functions of Python itself that need nothing but their arguments."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.python.formatting import as_string
from kg.extract.launch.ros2.python.machine import MAX_ITEMS, MAX_TEXT
from kg.extract.launch.ros2.python.operators import add, is_whole, truth
from kg.extract.launch.ros2.python.texts import known, reason_of
from kg.extract.launch.ros2.python.values import Guarded, Instance, Items, Klass, LoadedFile, Table, Unknown, pair_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.launch.ros2.python.call import Call
    from kg.extract.launch.ros2.python.values import Value

__all__ = ["BUILTINS", "FUNCTIONS", "chain", "product"]

_MAX_DIGITS: Final = 40


def _string(call: Call) -> Value:
    return as_string(call.args[0]) if call.args else ""


def _number(kind: type[int | float]) -> Callable[[Call], Value]:
    def convert(call: Call) -> Value:
        value = call.value("x", 0, 0)
        text = known(value, call.machine.context) if not isinstance(value, bool | int | float) else value
        if text is None or (isinstance(text, str) and len(text) > _MAX_DIGITS):
            return Unknown(reason_of(value))
        try:
            return kind(text)
        except (ValueError, OverflowError):
            return Unknown(f"`{text}` is no number")

    return convert


def _truth(call: Call) -> Value:
    found = truth(call.value("x", 0), call.machine.context)
    return Unknown(reason_of(call.value("x", 0))) if found is None else found


def _listed(call: Call) -> Value:
    if not call.args:
        return call.machine.items()
    found = call.machine.iterate(call.args[0])
    return Unknown(reason_of(call.args[0])) if found is None else call.machine.items(found)


def _tuple(call: Call) -> Value:
    found = _listed(call)
    return tuple(found) if isinstance(found, Items) else found


def _table(call: Call) -> Value:
    table = call.machine.table()
    for value in call.args[:1]:
        if isinstance(value, Table):
            call.machine.spread_table(table, value)
            continue
        pairs = call.machine.iterate(value)
        if pairs is None:
            table.rest = Unknown(reason_of(value))
        for pair in pairs or ():
            if (entry := pair_of(pair)) is not None:
                call.machine.put(table, *entry, call.location)
    for name, value in call.kwargs.items():
        call.machine.put(table, name, value, call.place(name))
    return table


def _range(call: Call) -> Value:
    bounds = call.args
    if not 1 <= len(bounds) <= 3 or not all(isinstance(bound, int) for bound in bounds):  # noqa: PLR2004 - as of range
        return Unknown(reason_of(next((bound for bound in bounds if not isinstance(bound, int)), None)))
    try:
        found = range(*[bound for bound in bounds if isinstance(bound, int)])
    except ValueError:
        return Unknown("the step of a range is zero")
    return call.machine.items(found) if len(found) <= MAX_ITEMS else Unknown("a range is too long")


def _enumerate(call: Call) -> Value:
    found = call.machine.iterate(call.value("iterable", 0))
    start = call.value("start", 1, 0)
    if found is None or not isinstance(start, int):
        return Unknown(reason_of(call.value("iterable", 0)))
    return call.machine.items(_numbered(number, item) for number, item in enumerate(found, start))


def _numbered(number: int, item: Value) -> Value:
    return Guarded(item.condition, (number, item.value)) if isinstance(item, Guarded) else (number, item)


def _zip(call: Call) -> Value:
    columns = [call.machine.iterate(value) for value in call.args]
    known_columns = [column for column in columns if column is not None]
    if len(known_columns) < len(columns):
        return Unknown(reason_of(call.args[columns.index(None)]))
    return call.machine.items(zip(*known_columns, strict=False))


def _length(call: Call) -> Value:
    value = call.value("obj", 0)
    if isinstance(value, str | tuple) or (isinstance(value, Table) and value.rest is None):
        return len(value)
    if isinstance(value, Items) and not any(isinstance(item, Guarded | Unknown) for item in value):
        return len(value)
    return Unknown(reason_of(value))


def _sorted(call: Call) -> Value:
    found = call.machine.iterate(call.value("iterable", 0))
    if found is None or "key" in call.kwargs:
        return Unknown("what is sorted is not known")
    backwards = call.value("reverse", None, default=False) is True
    texts = [item for item in found if isinstance(item, str)]
    numbers = [item for item in found if isinstance(item, int | float)]
    if len(texts) == len(found):
        return call.machine.items(sorted(texts, reverse=backwards))
    if len(numbers) == len(found):
        return call.machine.items(sorted(numbers, reverse=backwards))
    return Unknown("what is sorted is not known")


def _reversed(call: Call) -> Value:
    found = call.machine.iterate(call.value("sequence", 0))
    return Unknown(reason_of(call.value("sequence", 0))) if found is None else call.machine.items(reversed(found))


def _sum(call: Call) -> Value:
    found = call.machine.iterate(call.value("iterable", 0))
    if found is None:
        return Unknown(reason_of(call.value("iterable", 0)))
    total = call.value("start", 1, 0)
    for item in found:
        call.machine.step()
        total = add(total, item)
    return total


def _extreme(function: Callable[[list[float]], float]) -> Callable[[Call], Value]:
    def find(call: Call) -> Value:
        found = call.machine.iterate(call.args[0]) if len(call.args) == 1 else call.args
        numbers = [item for item in found or () if isinstance(item, int | float)]
        if not numbers or len(numbers) != len(found or ()):
            return Unknown("not all numbers are known")
        return function(numbers)

    return find


def _all(call: Call) -> Value:
    found = [truth(item, call.machine.context) for item in call.machine.iterate(call.value("iterable", 0)) or (None,)]
    return False if False in found else Unknown("not all are known") if None in found else True


def _any(call: Call) -> Value:
    found = [truth(item, call.machine.context) for item in call.machine.iterate(call.value("iterable", 0)) or (None,)]
    return True if True in found else Unknown("not all are known") if None in found else False


def _is_instance(call: Call) -> Value:
    value, kind = call.value("obj", 0), call.value("class_or_tuple", 1)
    if isinstance(value, Instance) and isinstance(kind, Klass):
        return value.klass is kind or kind in value.klass.bases
    names = {"builtins.str": str, "builtins.bool": bool, "builtins.int": int, "builtins.float": float}
    names |= {"builtins.list": Items, "builtins.dict": Table, "builtins.tuple": tuple}
    expected = names.get(getattr(kind, "path", ""))
    if expected is None or not (is_whole(value) or isinstance(value, Items | Table | tuple)):
        return Unknown("the type of a value is not known")
    return isinstance(value, expected)


def _attribute(call: Call) -> Value:
    name = known(call.value("name", 1))
    if name is None:
        return Unknown("the name of an attribute is not known")
    found = call.machine.attribute(call.value("object", 0), name)
    return call.args[2] if isinstance(found, Unknown) and len(call.args) > 2 else found  # noqa: PLR2004 - a default


def _open(call: Call) -> Value:
    path = call.value("file", 0)
    text = known(path, call.machine.context)
    file = call.machine.find_file(text) if text is not None else None
    data = call.machine.files.read(file) if file is not None else None
    if data is None:
        why = reason_of(path) if text is None else f"the file {text} is not in the build"
        return LoadedFile(None, file, why)
    return LoadedFile(data.decode("utf-8", "replace")[:MAX_TEXT], file)


def _map(call: Call) -> Value:
    found = call.machine.iterate(call.value("iterable", 1))
    if found is None:
        return Unknown(reason_of(call.value("iterable", 1)))
    return call.machine.items(call.again(call.args[0], [item]) for item in found)


def _filter(call: Call) -> Value:
    found = call.machine.iterate(call.value("iterable", 1))
    if found is None:
        return Unknown(reason_of(call.value("iterable", 1)))
    kept = call.machine.items()
    for item in found:
        holds = truth(item if call.args[0] is None else call.again(call.args[0], [item]), call.machine.context)
        if holds is None:
            return Unknown("what is filtered is not known")
        if holds:
            kept.append(item)
    return kept


def chain(call: Call) -> Value:
    """Return `itertools.chain`."""
    found = call.machine.items()
    for value in call.args:
        items = call.machine.iterate(value)
        found += items if items is not None else [value]
    return found


def product(call: Call) -> Value:
    """Return `itertools.product`."""
    columns = [call.machine.iterate(value) or [] for value in call.args]
    if call.kwargs or math.prod(len(column) for column in columns) > MAX_ITEMS:
        return Unknown("a product of lists is not known")
    return call.machine.items(itertools.product(*columns))


FUNCTIONS: Final[dict[str, Callable[[Call], Value]]] = {
    "str": _string,
    "int": _number(int),
    "float": _number(float),
    "bool": _truth,
    "list": _listed,
    "set": _listed,
    "frozenset": _listed,
    "iter": _listed,
    "tuple": _tuple,
    "dict": _table,
    "range": _range,
    "enumerate": _enumerate,
    "zip": _zip,
    "len": _length,
    "sorted": _sorted,
    "reversed": _reversed,
    "sum": _sum,
    "min": _extreme(min),
    "max": _extreme(max),
    "all": _all,
    "any": _any,
    "isinstance": _is_instance,
    "getattr": _attribute,
    "open": _open,
    "map": _map,
    "filter": _filter,
    "print": lambda _: None,
}

BUILTINS: Final = frozenset(
    {
        *FUNCTIONS,
        "super",
        "type",
        "object",
        "property",
        "staticmethod",
        "classmethod",
        "repr",
        "abs",
        "round",
        "hasattr",
        "setattr",
        "id",
        "hash",
        "input",
        "next",
        "exit",
        "quit",
        "Exception",
        "ValueError",
        "RuntimeError",
        "KeyError",
        "TypeError",
        "FileNotFoundError",
        "OSError",
        "IOError",
        "EnvironmentError",
        "ImportError",
        "ModuleNotFoundError",
        "AttributeError",
        "IndexError",
        "NotImplementedError",
        "LookupError",
        "AssertionError",
        "UnicodeDecodeError",
        "PermissionError",
        "BaseException",
        "SystemExit",
        "eval",
        "exec",
    }
)
"""The names of Python's own that mean something to the reader."""
