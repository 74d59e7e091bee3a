"""Functions of Python itself that need nothing but their arguments.

Python computes those of values that are wholly known. Functions that only arrange values take unknown ones as well.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any, Final

from kg.extract.launch.expressions.containers import Containers
from kg.extract.launch.expressions.formatting import as_string
from kg.extract.launch.expressions.joining import add
from kg.extract.launch.expressions.operators import truth
from kg.extract.launch.expressions.texts import known, reason_of
from kg.extract.launch.expressions.values import Guarded, Items, Table, Unknown, pair_of
from kg.extract.launch.expressions.whole import (
    MAX_ITEMS,
    ExpressionError,
    UnsupportedError,
    apply,
    is_whole,
    refuse_over,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.launch.expressions.call import Call
    from kg.extract.launch.expressions.evaluate import Evaluator
    from kg.extract.launch.expressions.values import Value

__all__ = ["CONSTANTS", "FUNCTIONS", "is_builtin", "settled"]

_MAX_DIGITS: Final = 400
_MAX_FACTORIAL: Final = 500
_UNBOUNDED: Final = {"comb", "dist", "fma", "lcm", "nextafter", "perm", "prod", "sumprod"}
"""Functions of `math` whose cost is not bounded by the size of their arguments, or that no launch file needs."""


def settled(call: Call, value: Value) -> Value:
    """Return an argument, as plain text where it is one that is wholly known."""
    text = known(value, call.machine.context)
    return value if text is None else text


def wholly(function: Callable[..., Any]) -> Callable[[Call], Value]:
    """Return a function of Python as one that is called where all of its arguments are known."""

    def run(call: Call) -> Value:
        args = [settled(call, value) for value in call.args]
        kwargs = {name: settled(call, value) for name, value in call.kwargs.items()}
        for value in (*args, *kwargs.values()):
            if not is_whole(value):
                return Unknown(reason_of(value))
        return call.machine.weigh(apply(function, args, kwargs, tuple(call.machine.guards)))

    return run


def _rounded(number: Any, ndigits: Any = None) -> object:
    if isinstance(ndigits, int) and abs(ndigits) > _MAX_DIGITS:
        raise UnsupportedError("a number is rounded to too many digits")
    return round(number, ndigits)


def _factorial(number: Any) -> int:
    if isinstance(number, int) and number > _MAX_FACTORIAL:
        raise UnsupportedError("a number grows too large")
    return math.factorial(number)


def _string(call: Call) -> Value:
    return as_string(call.args[0]) if len(call.args) == 1 and not call.kwargs else _text(call)


_text: Final = wholly(str)


def _truth(call: Call) -> Value:
    found = truth(call.value("x", 0), call.machine.context)
    return Unknown(reason_of(call.value("x", 0))) if found is None else found


def _iterated(call: Call, name: str = "iterable", position: int = 0) -> list[Value] | Unknown:
    value = call.value(name, position)
    found = call.machine.iterate(value)
    if found is not None:
        return found
    if isinstance(value, bool | int | float) or value is None:
        raise ExpressionError(f"TypeError: '{type(value).__name__}' object is not iterable")
    return Unknown(reason_of(value))


def _arranged(make: Callable[[Evaluator, list[Value]], Value], name: str = "iterable") -> Callable[[Call], Value]:
    """Return a function of what it is given to iterate over, by default nothing."""

    def run(call: Call) -> Value:
        found = _iterated(call, name) if call.args else []
        return found if isinstance(found, Unknown) else make(call.machine, found)

    return run


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
            entry = pair_of(pair)
            if entry is None:
                table.rest = Unknown(reason_of(pair))
            else:
                call.machine.put(table, *entry, call.location)
    for name, value in call.kwargs.items():
        call.machine.put(table, name, value, call.place(name))
    return table


def _range(*bounds: Any) -> list[int]:
    found = range(*bounds)
    refuse_over(len(found[: MAX_ITEMS + 1]), MAX_ITEMS)
    return list(found)


def _enumerate(call: Call) -> Value:
    found = _iterated(call)
    start = call.value("start", 1, 0)
    if isinstance(found, Unknown) or not isinstance(start, int):
        return found if isinstance(found, Unknown) else Unknown(reason_of(start))
    return call.machine.items(_numbered(number, item) for number, item in enumerate(found, start))


def _numbered(number: int, item: Value) -> Value:
    return Guarded(item.condition, (number, item.value)) if isinstance(item, Guarded) else (number, item)


def _zip(call: Call) -> Value:
    columns = [_iterated(call, "", position) for position in range(len(call.args))]
    unknown = next((column for column in columns if isinstance(column, Unknown)), None)
    return unknown or call.machine.items(zip(*(column for column in columns if isinstance(column, list)), strict=False))


_count: Final = wholly(len)


def _length(call: Call) -> Value:
    value = call.value("obj", 0)
    if isinstance(value, str | tuple) or (isinstance(value, Table) and value.rest is None):
        return len(value)
    if isinstance(value, Items) and not any(isinstance(item, Guarded | Unknown) for item in value):
        return len(value)
    return _count(call)


_total: Final = wholly(sum)


def _sum(call: Call) -> Value:
    """Return a sum; that of lists may have items that are not known."""
    found = _iterated(call)
    if isinstance(found, Unknown) or all(is_whole(item) for item in found):
        return found if isinstance(found, Unknown) else _total(call)
    total: Value = call.value("start", 1, 0)
    for item in found:
        call.machine.step()
        total = add(total, item)
    return total if total is not None else Unknown("what is summed up is not known")


def _quantified(*, every: bool) -> Callable[[Call], Value]:
    """Return `all` or `any`, which one item may decide."""

    def run(call: Call) -> Value:
        items = _iterated(call)
        if isinstance(items, Unknown):
            return items
        found = [None if isinstance(item, Guarded) else truth(item, call.machine.context) for item in items]
        if (not every) in found:
            return not every
        return Unknown("not all are known") if None in found else every

    return run


def _map(call: Call) -> Value:
    found = _iterated(call, "iterable", 1)
    if isinstance(found, Unknown):
        return found
    return call.machine.items(call.again(call.args[0], [item]) for item in found)


def _filter(call: Call) -> Value:
    found = _iterated(call, "iterable", 1)
    if isinstance(found, Unknown):
        return found
    kept = call.machine.items()
    for item in found:
        holds = truth(item if call.args[0] is None else call.again(call.args[0], [item]), call.machine.context)
        if holds is None:
            return Unknown("what is filtered is not known")
        if holds:
            kept.append(item)
    return kept


def _chain(call: Call) -> Value:
    """Return `itertools.chain`."""
    found = call.machine.items()
    for value in call.args:
        items = call.machine.iterate(value)
        found += items if items is not None else [value]
    return found


def _product(call: Call) -> Value:
    """Return `itertools.product`."""
    columns = [_iterated(call, "", position) for position in range(len(call.args))]
    lists = [column for column in columns if isinstance(column, list)]
    if call.kwargs or len(lists) < len(columns) or math.prod(len(column) for column in lists) > MAX_ITEMS:
        return Unknown("a product of lists is not known")
    return call.machine.items(itertools.product(*lists))


CONSTANTS: Final[dict[str, Value]] = {f"math.{name}": getattr(math, name) for name in ("e", "inf", "nan", "pi", "tau")}
"""Constants of modules by their full names."""

FUNCTIONS: Final[dict[str, Callable[[Call], Value]]] = {
    **{
        f"builtins.{function.__name__}": wholly(function)
        for function in (abs, ascii, bin, chr, divmod, float, hex, int, max, min, oct, ord, repr, sorted)
    },
    **{
        f"math.{name}": wholly(getattr(math, name))
        for name in dir(math)
        if name not in _UNBOUNDED and callable(getattr(math, name)) and not name.startswith("_")
    },
    "math.factorial": wholly(_factorial),
    "builtins.round": wholly(_rounded),
    "builtins.range": wholly(_range),
    "collections.OrderedDict": _table,
    "itertools.chain": _chain,
    "itertools.product": _product,
    "builtins.str": _string,
    "builtins.bool": _truth,
    **dict.fromkeys(("builtins.list", "builtins.iter"), _arranged(Containers.items)),
    **dict.fromkeys(("builtins.set", "builtins.frozenset"), _arranged(Containers.distinct)),
    "builtins.tuple": _arranged(lambda _, found: tuple(found)),
    "builtins.reversed": _arranged(lambda machine, found: machine.items(reversed(found)), "sequence"),
    "builtins.dict": _table,
    "builtins.enumerate": _enumerate,
    "builtins.zip": _zip,
    "builtins.len": _length,
    "builtins.sum": _sum,
    "builtins.all": _quantified(every=True),
    "builtins.any": _quantified(every=False),
    "builtins.map": _map,
    "builtins.filter": _filter,
}
"""Functions by their full names."""


def is_builtin(name: str) -> bool:
    """Tell whether a name is that of a function of Python which is evaluated."""
    return f"builtins.{name}" in FUNCTIONS
