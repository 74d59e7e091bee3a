"""Functions of Python and ROS that need nothing but their arguments, as far as names are concerned."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.extract.python import formatting
from kg.extract.python.core import COMPUTED
from kg.extract.python.entities import Dotted, Items, Nothing, QosValue, Table, plain
from kg.extract.python.qos import lasting, preset, read_qos
from kg.extract.values import (
    COMMAND_LINE,
    OWN_NAMESPACE,
    Number,
    Text,
    concatenate,
    is_whole_parameter,
    keys_of_parameter,
    part_of_parameter,
)
from kg.facts import Resolution

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.python.entities import Thing
    from kg.extract.values import Value

__all__ = ["PURE"]


def _join_path(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    """`os.path.join` and the name joins of ROS: parts with one slash between; an absolute part starts anew."""
    del receiver, named
    pieces = [formatting.stringify(value) for value in values]
    joined: Text = concatenate()
    for piece in pieces:
        part = piece if isinstance(piece, Text) else concatenate(piece)
        first = part.parts[0] if part.parts else None
        if first is not None and first.startswith(("/", "~")):
            joined = part
            continue
        last = joined.parts[-1] if joined.parts else ""
        needs = bool(joined.parts) and not (last is not None and last.endswith("/")) and last != ""
        joined = concatenate(joined, *([Text.of("/")] if needs else []), part)
    return joined


def _join(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    """`separator.join(parts)`."""
    del named
    if not isinstance(receiver, Text) or len(values) != 1 or not isinstance(values[0], Items):
        return COMPUTED
    pieces = []
    for index, item in enumerate(values[0].items):
        pieces.extend([receiver, item] if index else [item])
    return concatenate(*map(formatting.stringify, pieces))


def _format(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    return formatting.format_braces(receiver, values, named) if isinstance(receiver, Text) else COMPUTED


def _split(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del named
    separator = plain(values[0]) if values else None
    if not isinstance(receiver, Text) or receiver.known is None or (values and not isinstance(separator, str)):
        return COMPUTED
    parts = receiver.known.split(separator if isinstance(separator, str) and separator else None)
    return Items(tuple(replace(receiver, parts=(part,)) for part in parts))


def _string_method(name: str) -> Callable[[Thing, list[Thing], dict[str, Thing]], Thing]:
    def apply(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
        del named
        given = [plain(value) for value in values]
        known = receiver.known if isinstance(receiver, Text) else None
        if not isinstance(receiver, Text) or not all(isinstance(item, str) for item in given):
            return COMPUTED
        if known is None:
            return receiver if name in ("strip", "rstrip", "lstrip", "encode", "decode") else concatenate(COMPUTED)
        return replace(receiver, parts=(formatting.STRING_METHODS[name](known, [str(item) for item in given]),))

    return apply


def _dictionary(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    """`dict(...)` and `OrderedDict(...)`."""
    del receiver
    pairs: tuple[tuple[Thing, Thing], ...] = ()
    if values and isinstance(values[0], Table):
        pairs = values[0].items
    elif values and isinstance(values[0], Items):
        rows = [item.items for item in values[0].items if isinstance(item, Items)]
        pairs = tuple((row[0], row[1]) for row in rows if len(row) == 2)  # noqa: PLR2004 - key and value
    elif values:
        return COMPUTED
    return Table((*pairs, *((Text.of(name), value) for name, value in named.items())))


def _elements(value: Thing) -> tuple[Thing, ...] | None:
    if isinstance(value, Text) and is_whole_parameter(value):
        return (part_of_parameter(value, COMPUTED),)
    if isinstance(value, Items):
        return value.items
    return tuple(key for key, _ in value.items) if isinstance(value, Table) else None


def _listed(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    """`list(x)`, `tuple(x)`, `sorted(x)`, `reversed(x)`, `set(x)`."""
    del receiver, named
    elements = _elements(values[0]) if values else ()
    return COMPUTED if elements is None else Items(elements)


def _zip(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del receiver, named
    columns = [_elements(value) for value in values]
    known = [column for column in columns if column is not None]
    if len(known) != len(columns):
        return COMPUTED
    return Items(tuple(Items(row) for row in zip(*known, strict=False)))


def _enumerate(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del receiver
    elements = _elements(values[0]) if values else None
    start = plain(named.get("start", values[1] if len(values) > 1 else Number(0, "0")))
    if elements is None or not isinstance(start, int | float):
        return COMPUTED
    return Items(tuple(Items((_number(int(start) + index), item)) for index, item in enumerate(elements)))


def _range(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del receiver, named
    bounds = [plain(value) for value in values]
    if not bounds or len(bounds) > 3 or not all(isinstance(bound, int | float) for bound in bounds):  # noqa: PLR2004 - start, stop, step
        return COMPUTED
    numbers = [int(bound or 0) for bound in bounds]
    if len(numbers) == 3 and numbers[2] == 0:  # noqa: PLR2004 - start, stop, step
        return COMPUTED
    return Items(tuple(_number(number) for number in range(*numbers)[:_MAX_RANGE]))


_MAX_RANGE: Final = 64


def _number(value: int) -> Number:
    return Number(value, str(value))


def _length(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del receiver, named
    elements = _elements(values[0]) if values else None
    return COMPUTED if elements is None else _number(len(elements))


def _class_of(kind: str) -> Callable[[Thing, list[Thing], dict[str, Thing]], Thing]:
    """`get_message_class("package/Type")` and its like."""

    def apply(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
        del receiver, named
        name = plain(values[0]) if values else None
        package, _, last = name.partition("/") if isinstance(name, str) else ("", "", "")
        return Dotted(f"{package}.{kind}.{last}") if package and last and "/" not in last else COMPUTED

    return apply


def _string(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del receiver, named
    return concatenate(formatting.stringify(values[0])) if values else Text.of("")


def _first(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del receiver, named
    return values[0] if values else COMPUTED


def _pairs(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del values, named
    if isinstance(receiver, Text) and is_whole_parameter(receiver):
        return Items((Items((keys_of_parameter(receiver), part_of_parameter(receiver, COMPUTED))),))
    return Items(tuple(Items(pair) for pair in receiver.items)) if isinstance(receiver, Table) else COMPUTED


def _keys(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del values, named
    if isinstance(receiver, Text) and is_whole_parameter(receiver):
        return Items((keys_of_parameter(receiver),))
    return Items(tuple(key for key, _ in receiver.items)) if isinstance(receiver, Table) else COMPUTED


def _held(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del values, named
    if isinstance(receiver, Text) and is_whole_parameter(receiver):
        return Items((part_of_parameter(receiver, COMPUTED),))
    return Items(tuple(value for _, value in receiver.items)) if isinstance(receiver, Table) else COMPUTED


def _get(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del named
    if isinstance(receiver, Text) and values and is_whole_parameter(receiver):
        part, default = part_of_parameter(receiver, _as_value(values[0])), values[-1]
        if len(values) == 1 or not isinstance(default, Text):
            return part
        return replace(default, parameter=part.parameter, resolution=Resolution.PARAMETER_DEFAULT)
    if not isinstance(receiver, Table) or not values:
        return COMPUTED
    return receiver.get(values[0]) or (values[1] if len(values) > 1 else Nothing())


def _as_value(value: Thing) -> Value:
    return value if isinstance(value, Text) else COMPUTED


def _text(text: str) -> Callable[[Thing, list[Thing], dict[str, Thing]], Thing]:
    def apply(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
        del receiver, values, named
        return Text.of(text, Resolution.CONSTANT)

    return apply


def _command_line(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del receiver, values, named
    return COMMAND_LINE


def _qos(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del receiver
    qos = read_qos(values, named)
    return QosValue(qos) if qos is not None else COMPUTED


def _preset(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    """`QoSPresetProfiles.get_from_short_key("sensor_data")`."""
    del receiver, named
    name = plain(values[0]) if values else None
    qos = preset(f"QoSPresetProfiles.{name}") if isinstance(name, str) else None
    return QosValue(qos) if qos is not None else COMPUTED


def _duration(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del receiver, values
    return lasting(named) or COMPUTED


PURE: Final[dict[str, Callable[[Thing, list[Thing], dict[str, Thing]], Thing]]] = {
    **{f"builtins.{name}": _listed for name in ("list", "tuple", "sorted", "reversed", "set", "frozenset", "iter")},
    **{f"builtins.{name}": _string for name in ("str", "unicode", "repr")},
    **{f"builtins.{name}": _first for name in ("int", "float", "bool")},
    **{f"builtins.{name}": _range for name in ("range", "xrange")},
    "builtins.zip": _zip,
    "itertools.izip": _zip,
    "builtins.enumerate": _enumerate,
    "builtins.len": _length,
    "builtins.dict": _dictionary,
    "collections.OrderedDict": _dictionary,
    "rospy.numpy_msg.numpy_msg": _first,
    "copy.copy": _first,
    "copy.deepcopy": _first,
    **dict.fromkeys(("os.path.join", "posixpath.join"), _join_path),
    **{f"{package}.names.ns_join": _join_path for package in ("rosgraph", "roslib", "rospy")},
    "str.join": _join,
    "str.format": _format,
    "str.split": _split,
    **{f"str.{name}": _string_method(name) for name in formatting.STRING_METHODS},
    **{f"{kind}.{name}": _pairs for kind in ("dict", "str") for name in ("items", "iteritems", "viewitems")},
    **{f"{kind}.{name}": _keys for kind in ("dict", "str") for name in ("keys", "iterkeys")},
    **{f"{kind}.{name}": _held for kind in ("dict", "str") for name in ("values", "itervalues")},
    **dict.fromkeys(("dict.get", "str.get"), _get),
    **{f"rospy.{name}": _text("~") for name in ("get_name", "get_caller_id", "names.get_caller_id")},
    **{f"rospy.{name}": _text(OWN_NAMESPACE) for name in ("get_namespace", "names.get_namespace")},
    "roslib.message.get_message_class": _class_of("msg"),
    "roslib.message.get_service_class": _class_of("srv"),
    "rospy.myargv": _command_line,
    "rospy.client.myargv": _command_line,
    "rclpy.qos.QoSProfile": _qos,
    "rclpy.qos.QoSPresetProfiles.get_from_short_key": _preset,
    **dict.fromkeys(("rclpy.duration.Duration", "rclpy.time.Duration", "rclpy.qos.Duration"), _duration),
}  # fmt: skip
"""Functions that need nothing but their arguments, by full name; methods under `str`, `dict`, `list`.

The value of a parameter without default is a text that is not known, whatever it turns out to be."""
