"""Durations: `100ms`, `std::chrono::seconds(1)`, `rclcpp::Duration(1, 0)` and `rmw_time_t`, in seconds.

A duration is an object with the native value `seconds`. Sources: rclcpp/duration.hpp (one number is nanoseconds, two
are seconds and nanoseconds), rmw/time.h, rmw/types.h, ros/duration.h (one number is seconds).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.symbolic.values import Kind, Number, Object, Sequence, TypeValue, Unknown, Value, number

if TYPE_CHECKING:
    from kg.symbolic.machine import Machine

DURATION: Final = Kind(("rclcpp", "Duration"))
INFINITE: Final = 9_223_372_036.0
"""Durations from here on have no end: 64 bits of nanoseconds hold no more (RMW_DURATION_INFINITE)."""
CONSTANTS: Final = {
    "RMW_DURATION_INFINITE": INFINITE,
    "RMW_DURATION_UNSPECIFIED": 0.0,
    "RMW_QOS_DEADLINE_DEFAULT": 0.0,
    "RMW_QOS_DEADLINE_BEST_AVAILABLE": 0.0,
    "RMW_QOS_LIFESPAN_DEFAULT": 0.0,
    "RMW_QOS_LIVELINESS_LEASE_DURATION_DEFAULT": 0.0,
    "RMW_QOS_LIVELINESS_LEASE_DURATION_BEST_AVAILABLE": 0.0,
}
METHODS: Final = frozenset({"seconds", "toSec", "fromSec", "count"})
_UNITS: Final = {
    "nanoseconds": 1e-9,
    "microseconds": 1e-6,
    "milliseconds": 1e-3,
    "seconds": 1.0,
    "minutes": 60.0,
    "hours": 3600.0,
}
"""What the classes of std::chrono count."""
_RATIOS: Final = {"ratio": 1.0, "milli": 1e-3, "micro": 1e-6, "nano": 1e-9}
_NANOSECOND: Final = 1e-9
_DIGITS: Final = 9


def duration(seconds: float | None, kind: Kind = DURATION) -> Object:
    """Return a duration; None for an unknown one."""
    return Object(kind, native={} if seconds is None else {"seconds": number(seconds)})


def construct_duration(kind: Kind, unit: float, arguments: list[Value]) -> Object:
    """Return the duration that a constructor makes: of one number in its unit, of two, or of another duration."""
    if len(arguments) != 1:
        return duration(seconds_of(Sequence(tuple(arguments))), kind)
    first = arguments[0]
    if not isinstance(first, Number):
        return duration(seconds_of(first), kind)
    scale = _ratio(kind.arguments[1]) if len(kind.arguments) > 1 else unit
    return duration(round(first.value * scale, _DIGITS) if scale is not None else None, kind)


def _ratio(argument: Value) -> float | None:
    """Return the unit of `std::chrono::duration<double, std::milli>` in seconds."""
    name = argument.kind.name if isinstance(argument, TypeValue) and not argument.kind.arguments else ""
    return _RATIOS.get(name)


def seconds_of(value: Value) -> float | None:
    """Return a duration in seconds, `INFINITE` or more if it has no end; None if it is unknown."""
    if isinstance(value, Sequence):
        return _of_parts(value.items[0], value.items[1]) if len(value.items) == 2 else None  # noqa: PLR2004 - a pair
    if not isinstance(value, Object):
        return None
    seconds = value.native.get("seconds")
    if not {"sec", "nsec"} & value.fields.keys():
        return seconds.value if isinstance(seconds, Number) else None
    before = seconds.value if isinstance(seconds, Number) else 0.0
    whole = value.fields.get("sec", number(before // 1))
    return _of_parts(whole, value.fields.get("nsec", number(round(before % 1 / _NANOSECOND))))


def called(machine: Machine, of: Object, name: str, arguments: list[Value]) -> Value | None:
    """Return the result of a method of a duration; None for other objects and methods."""
    if name not in METHODS or "seconds" not in of.native:
        return None
    if name == "fromSec" and len(arguments) == 1:
        machine.write(of.native, "seconds", arguments[0])
        return of
    seconds, unit = seconds_of(of), _UNITS.get(of.kind.name) if name == "count" else None
    if seconds is None or (name == "count" and unit is None):
        return Unknown("the duration is not known")
    return Number(seconds, repr(seconds)) if unit is None else number(round(seconds / unit))


def _of_parts(seconds: Value, nanoseconds: Value) -> float | None:
    if isinstance(seconds, Number) and isinstance(nanoseconds, Number):
        return round(seconds.value + nanoseconds.value * _NANOSECOND, _DIGITS)
    return None


def scaled(sign: str, row: tuple[Value, ...]) -> Object | None:
    """Return the duration that `2 * 100ms`, `1s / 4` or `1s + 5ms` computes; None if no operand is a duration."""
    if sign not in ("+", "-", "*", "/"):
        return None
    first = next((value for value in row if isinstance(value, Object) and "seconds" in value.native), None)
    if first is None:
        return None
    values = [value.value if isinstance(value, Number) else seconds_of(value) for value in row]
    durations = sum(1 for value in row if isinstance(value, Object))
    valid = durations == len(row) if sign in ("+", "-") else durations == 1 and (sign == "*" or row[0] is first)
    result = values[0]
    for value in values[1:]:
        if result is None or value is None or not valid or (sign == "/" and value == 0):
            return duration(None, first.kind)
        steps = {"+": result + value, "-": result - value, "*": result * value, "/": result / (value or 1.0)}
        result = round(steps[sign], _DIGITS)
    return duration(result, first.kind)
