"""Functions of Python and its libraries that compute something of their arguments alone."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

from kg.extract.python import paths, texts
from kg.holes import Hole
from kg.symbolic import containers
from kg.symbolic.containers import COMMAND_LINE, is_unknown_parameter, key_of
from kg.symbolic.operators import compute, plain, truth
from kg.symbolic.values import (
    LENGTH,
    Kind,
    Mapping,
    Number,
    Sequence,
    Text,
    Truth,
    TypeValue,
    Unknown,
    Value,
    as_text,
    concatenate,
    join,
    number,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from collections.abc import Mapping as Names

_COMPUTED: Final = Unknown("it is computed when the program runs")
_LONGEST_NUMBER: Final = 40
_MOST_ITEMS: Final = 5_000


def elements(of: Value) -> list[Value]:
    """Return what a loop over a value gives."""
    if isinstance(of, Mapping):
        keys = [key for key, _ in of.items]
        return keys if keys or of.parameter is None else [key_of(of.parameter)]
    if isinstance(of, Text) and of.exact is not None and of.parameter is None:
        return [replace(of, parts=(letter,), own=False) for letter in of.exact[:_MOST_ITEMS]]
    return containers.elements(of)


def is_open(of: Value) -> bool:
    """Check whether a container may have more items."""
    return isinstance(of, Sequence | Mapping) and of.open


def _listed(values: list[Value]) -> Value:
    """`list(x)`, `tuple(x)`, `set(x)`."""
    if not values:
        return Sequence(())
    of = values[0]
    if (isinstance(of, Mapping) and of.items) or (isinstance(of, Text) and of.exact is not None):
        return Sequence(tuple(elements(of)), is_open(of))
    return of


def countable(value: Value) -> list[Value] | None:
    """Return the items of a value, if all are known; None for others."""
    complete = isinstance(value, Sequence | Mapping) and not value.open
    complete = complete or (isinstance(value, Text) and value.exact is not None)
    return elements(value) if complete or is_unknown_parameter(value) else None


def _zip(values: list[Value]) -> Value:
    columns = [column for value in values if (column := countable(value)) is not None]
    if len(columns) < len(values):
        return _COMPUTED
    return Sequence(tuple(Sequence(row) for row in zip(*columns, strict=False)))


def _range(values: list[Value]) -> Value:
    bounds = [value.whole for value in values if isinstance(value, Number)]
    if not bounds or len(bounds) != len(values) or len(bounds) > 3 or bounds[2:] == [0]:  # noqa: PLR2004 - start, stop, step
        return _COMPUTED
    numbers = range(*bounds)
    if not numbers and any(isinstance(value, Number) and value.parameter is not None for value in values):
        return _COMPUTED
    return Sequence(tuple(map(number, numbers))) if not numbers[_MOST_ITEMS:] else Unknown("a range is too long")


def _length(values: list[Value]) -> Value:
    of = values[0] if values else _COMPUTED
    if isinstance(of, Sequence) and of.parameter == "argv":
        return Unknown("it is the number of arguments", "argc")
    if isinstance(of, Sequence) and of.repeated:
        return LENGTH
    if isinstance(of, Sequence | Mapping) and not of.open and (of.items or of.parameter is None):
        return number(len(of.items), of.parameter)
    return number(len(of.exact), of.parameter) if isinstance(of, Text) and of.exact is not None else _COMPUTED


def _join_names(values: list[Value]) -> Value:
    """The joins of names; a private name starts again."""
    private = [index for index, one in enumerate(values) if isinstance(one, Text) and one.shown.startswith("~")]
    return paths.joined(values[private[-1] if private else 0 :])


def _of_path(values: list[Value], apply: Callable[[Text], Value]) -> Value:
    """Return the result of a function of one path."""
    return apply(as_text(values[0])) if values else _COMPUTED


def _typed(kind: str) -> Callable[[list[Value]], Value]:
    """`get_message_class("package/Type")` and its like."""

    def apply(values: list[Value]) -> Value:
        name = values[0].exact if values and isinstance(values[0], Text) else None
        parts = name.split("/") if name else []
        parameter = getattr(values[0], "parameter", None) if values else None
        if parameter is not None:  # a launch file that sets it means another type
            return Unknown("it depends on a parameter", parameter)
        return TypeValue(Kind((parts[0], kind, parts[-1]))) if len(parts) > 1 else _COMPUTED

    return apply


def _converted(values: list[Value], convert: Callable[[str | float], Value]) -> Value:
    of = values[0] if values else number(0)
    text = plain(of)
    if isinstance(of, Text) and of.exact is None and of.parameter is None:
        label = of.parts[0].label if len(of.parts) == 1 and isinstance(of.parts[0], Hole) else None
        return Unknown(of.reason or "it is computed when the program runs", label=label or None)
    if text is None or getattr(of, "parameter", None) is not None or len(str(text)) > _LONGEST_NUMBER:
        return of
    try:
        return convert(text)
    except (ValueError, OverflowError):
        return Unknown(f"`{text}` is not a number")


def _truth(values: list[Value]) -> Value:
    """`bool(x)`."""
    of = values[0] if values else Truth(False)
    result = truth(of)
    return result if isinstance(result, Truth) else of


def _absolute(values: list[Value]) -> Value:
    """`abs(x)`."""
    of = values[0] if values else _COMPUTED
    if not isinstance(of, Number):
        return of
    return Number(abs(of.value), of.written.removeprefix("-"), of.parameter)


def _plain(values: list[Value] | None) -> list[str] | list[float] | None:
    """Return texts, or numbers, that are all known; None for others."""
    texts = [one.exact for one in values or () if isinstance(one, Text) and one.exact is not None]
    if texts and len(texts) == len(values or ()):
        return texts
    numbers = [one.value for one in values or () if isinstance(one, Number)]
    return numbers if len(numbers) == len(values or ()) else None


def _reversed(values: list[Value]) -> Value:
    items = countable(values[0]) if values else None
    return Sequence(tuple(reversed(items))) if items is not None else values[0] if values else _COMPUTED


def _sum(values: list[Value]) -> Value:
    """`sum(x, start)`."""
    items = countable(values[0]) if values else None
    if items is None:
        return _COMPUTED
    start = values[1] if len(values) > 1 else number(0)
    return compute("+", (start, *items)) if items else start


def _extreme(choose: Callable[[Iterable[int], Callable[[int], float]], int]) -> Callable[..., Value]:
    def apply(values: list[Value]) -> Value:
        items = countable(values[0]) if len(values) == 1 else values
        numbers = [one.value for one in items or () if isinstance(one, Number)]
        if not items or len(numbers) < len(items):
            return _COMPUTED
        return items[choose(range(len(numbers)), numbers.__getitem__)]

    return apply


def _all_of(wanted: bool) -> Callable[..., Value]:  # noqa: FBT001 - `all` or `any`
    def apply(values: list[Value]) -> Value:
        truths = {truth(one) for one in (countable(values[0]) if values else None) or [_COMPUTED]}
        if Truth(not wanted) in truths:
            return Truth(not wanted)
        return Truth(wanted) if truths <= {Truth(wanted)} else Unknown("not all are known")

    return apply


def _chain(values: list[Value]) -> Value:
    """`itertools.chain(*x)`."""
    columns = [countable(value) for value in values]
    return Sequence(tuple(one for column in columns for one in column or ()), open=None in columns)


def _product(values: list[Value]) -> Value:
    """`itertools.product(*x)`."""
    columns = [column for value in values if (column := countable(value)) is not None]
    if len(columns) < len(values) or math.prod(map(len, columns)) > _MOST_ITEMS:
        return _COMPUTED
    return Sequence(tuple(Sequence(row) for row in itertools.product(*columns)))


def _in_base(values: list[Value], call: Callable[[int], str]) -> Value:
    """`hex(x)`, `oct(x)` and `bin(x)`."""
    of = values[0] if values else _COMPUTED
    if isinstance(of, Number) and of.parameter is None and math.isfinite(of.value):
        return Text.of(call(int(of.value)))
    return _COMPUTED


FUNCTIONS: Final[dict[str, Callable[[list[Value]], Value]]] = {
    **{f"builtins.{name}": _listed for name in ("list", "tuple", "set", "frozenset", "iter")},
    **dict.fromkeys(
        ("builtins.str", "builtins.unicode", "builtins.repr"),
        lambda values: concatenate(texts.stringified(values[0])) if values else Text.of(""),
    ),
    **{f"builtins.{name}": _range for name in ("range", "xrange")},
    **dict.fromkeys(("builtins.zip", "itertools.izip"), _zip),
    "builtins.len": _length,
    "builtins.int": lambda values: _converted(values, lambda value: number(int(value))),
    "builtins.float": lambda values: _converted(values, lambda value: Number(float(value), repr(float(value)))),
    "builtins.bool": _truth,
    **{f"builtins.{call.__name__}": partial(_in_base, call=call) for call in (hex, oct, bin)},
    "builtins.abs": _absolute,
    "builtins.reversed": _reversed,
    "builtins.sum": _sum,
    "builtins.min": _extreme(lambda indexes, value: min(indexes, key=value)),
    "builtins.max": _extreme(lambda indexes, value: max(indexes, key=value)),
    "builtins.all": _all_of(True),
    "builtins.any": _all_of(False),
    "itertools.chain": _chain,
    "itertools.product": _product,
    **dict.fromkeys(
        ("rospy.numpy_msg.numpy_msg", "copy.copy", "copy.deepcopy"), lambda values: values[0] if values else _COMPUTED
    ),
    "ast.literal_eval": lambda values: values[0] if values and isinstance(values[0], Truth | Number) else _COMPUTED,
    "collections.defaultdict": lambda values: Mapping((), default=values[0] if values else None),
    **{name: partial(_of_path, apply=apply) for name, apply in paths.FUNCTIONS.items()},
    **{f"pathlib.{name}": paths.joined for name in ("Path", "PurePath", "PosixPath")},
    **dict.fromkeys(("os.path.join", "posixpath.join"), paths.joined),
    **{f"{package}.names.ns_join": _join_names for package in ("rosgraph", "roslib", "rospy")},
    **{f"roslib.message.get_{name}_class": _typed(kind) for name, kind in (("message", "msg"), ("service", "srv"))},
    **{
        f"rosidl_runtime_py.utilities.get_{name}": _typed(kind)
        for name, kind in (("message", "msg"), ("service", "srv"), ("action", "action"))
    },
    **dict.fromkeys(("rospy.myargv", "rospy.client.myargv", "rclpy.utilities.remove_ros_args"), lambda _: COMMAND_LINE),
}
"""Functions by name."""


def _sorted(values: list[Value], named: Names[str, Value]) -> Value:
    """`sorted(x, reverse=False)`; items that are not known stay where they are."""
    items = countable(values[0]) if values else None
    if items is None:
        return values[0] if values else _COMPUTED
    order = _plain(items)
    if order is not None:
        items = [one for _, _, one in sorted(zip(order, itertools.count(), items, strict=False))]
    return Sequence(tuple(items[::-1] if named.get("reverse") == Truth(True) else items))


def _enumerate(values: list[Value], named: Names[str, Value]) -> Value:
    items = countable(values[0]) if values else None
    start = named.get("start", values[1] if len(values) > 1 else number(0))
    if not values:
        return _COMPUTED
    if items is None or not isinstance(start, Number):
        return Sequence(tuple(Sequence((_COMPUTED, one)) for one in elements(values[0])), open=True)
    return Sequence(tuple(Sequence((number(start.value + index), item)) for index, item in enumerate(items)))


def _dictionary(values: list[Value], named: Names[str, Value]) -> Value:
    pairs: tuple[tuple[Value, Value], ...] = ()
    is_open = False
    if values and isinstance(values[0], Mapping):
        pairs, is_open = values[0].items, values[0].open
    elif values and isinstance(values[0], Sequence):
        rows = [item.items for item in values[0].items if isinstance(item, Sequence)]
        pairs = tuple((row[0], row[1]) for row in rows if len(row) == 2)  # noqa: PLR2004 - key and value
        is_open = values[0].open or len(pairs) < len(values[0].items)
    elif values:
        return _COMPUTED
    return Mapping((*pairs, *((Text.of(name), value) for name, value in named.items())), is_open)


def _environment(values: list[Value], named: Names[str, Value]) -> Value:
    """`os.environ.get("NAME", default)` and `os.getenv`: what the environment gives, or the default."""
    default = values[1] if len(values) > 1 else named.get("default")
    unknown = from_environment(values[0] if values else _COMPUTED)
    if isinstance(default, (Truth, Number)):
        return join(default, unknown)  # the type is that of the default, which holds without the variable
    return join(unknown, default) if isinstance(default, Text) else unknown


def from_environment(name: Value) -> Value:
    """Return a variable of the environment."""
    return Text.hole("it is read from the environment", name.exact or "" if isinstance(name, Text) else "")


_MEMBERS_AS_KEYS: Final = (
    "addict.Dict", "attrdict.AttrDict", "attrdict.AttrMap", "box.Box", "bunch.Bunch", "dotmap.DotMap",
    "easydict.EasyDict", "munch.Munch", "munch.munchify", "types.SimpleNamespace",
)  # fmt: skip
"""Classes of maps whose members are the elements with these keys."""
NAMED: Final[dict[str, Callable[[list[Value], Names[str, Value]], Value]]] = {
    "builtins.sorted": _sorted,
    "builtins.enumerate": _enumerate,
    **dict.fromkeys(("builtins.dict", "collections.OrderedDict", *_MEMBERS_AS_KEYS), _dictionary),
    **dict.fromkeys(("os.environ.get", "os.getenv"), _environment),
}
"""Functions with arguments by name."""
