"""Quality of service of ROS 2 in Python: profiles, presets, a plain depth.

Source: the presets of `rclpy.qos` (rmw/qos_profiles.h). What a profile leaves out is what rclpy's QoSProfile leaves
to the default profile: reliable, volatile, keep last, no deadline. A duration of zero stands for the default, which is
none (RMW_DURATION_UNSPECIFIED in rmw/types.h).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.extract.python.entities import Dotted, QosValue
from kg.extract.values import Number
from kg.facts import Qos

if TYPE_CHECKING:
    from kg.extract.python.entities import Thing

__all__ = ["FIELDS", "INFINITE", "changed", "lasting", "preset", "quality", "read_qos"]

INFINITE: Final = 9_223_372_036.0
"""Seconds from which on a duration stands for none: 64 bits of nanoseconds hold no more (RMW_DURATION_INFINITE)."""

_DEFAULT: Final = Qos("reliable", "volatile", "keep_last", 10)

_PRESETS: Final[dict[str, Qos]] = {
    "sensor_data": Qos("best_effort", "volatile", "keep_last", 5),
    "system_default": Qos("system_default", "system_default", "system_default", None),
    "services_default": Qos("reliable", "volatile", "keep_last", 10),
    "parameters": Qos("reliable", "volatile", "keep_last", 1000),
    "parameter_events": Qos("reliable", "volatile", "keep_last", 1000),
    "action_status_default": Qos("reliable", "transient_local", "keep_last", 1),
    "best_available": Qos("best_available", "best_available", "keep_last", 10),
    "default": _DEFAULT,
}

_POLICIES: Final = ("reliability", "durability", "history")
_DURATIONS: Final = {
    "deadline": "deadline",
    "lifespan": "lifespan",
    "liveliness_lease_duration": "lease_duration",
}
"""Fields of a profile that are durations, with those of `Qos`."""
_LIVELINESS: Final = frozenset({"automatic", "manual_by_topic"})
FIELDS: Final = ("depth", *_POLICIES, "liveliness", *_DURATIONS)
"""The fields of rclpy's QoSProfile that are read."""
_PREFIXES: Final = ("rmw_qos_", "reliability_", "durability_", "history_", "policy_")


def preset(path: str) -> Qos | None:
    """Return the preset that a name of `rclpy.qos` stands for (`qos_profile_sensor_data`, `QoSPresetProfiles.X`)."""
    parts = path.removesuffix(".value").split(".")
    name = parts[-1].lower()
    if "QoSPresetProfiles" in parts or name.startswith("qos_profile_"):
        return _PRESETS.get(name.removeprefix("qos_profile_"))
    return None


def quality(value: Thing | None) -> Qos | None:
    """Return the quality of service that an argument stands for: a depth, a preset or a profile."""
    if isinstance(value, Number):
        return Qos("reliable", "volatile", "keep_last", int(value.value))
    if isinstance(value, QosValue):
        return value.qos
    return preset(value.path) if isinstance(value, Dotted) else None


def read_qos(values: list[Thing], named: dict[str, Thing]) -> Qos | None:
    """Return the profile that `QoSProfile(...)` makes of its arguments; None where a duration of it is not known."""
    given = {"depth": values[0], **named} if values else named
    return changed(replace(_DEFAULT, depth=None), given)


def changed(qos: Qos, values: dict[str, Thing]) -> Qos | None:
    """Return a profile with some of its fields given other values; None where a duration of these is not known.

    A deadline that is not known must not read as none: that would make ends incompatible that may well be compatible.
    """
    depth, liveliness = values.get("depth"), values.get("liveliness")
    lasting = {own: _duration(values[name]) for name, own in _DURATIONS.items() if name in values}
    kind = _policy(liveliness, "liveliness") if liveliness is not None else qos.liveliness
    if None in lasting.values():
        return None
    seconds = {own: value if value and value < INFINITE else None for own, value in lasting.items()}
    policies = {name: _policy(values[name], name) for name in _POLICIES if name in values}
    return replace(
        qos,
        depth=int(depth.value) if isinstance(depth, Number) else qos.depth,
        reliability=policies.get("reliability", qos.reliability),
        durability=policies.get("durability", qos.durability),
        history=policies.get("history", qos.history),
        deadline=seconds.get("deadline", qos.deadline),
        lifespan=seconds.get("lifespan", qos.lifespan),
        lease_duration=seconds.get("lease_duration", qos.lease_duration),
        liveliness=kind if kind in _LIVELINESS else None,
    )


def lasting(named: dict[str, Thing]) -> Number | None:
    """Return the seconds that `Duration(seconds=..., nanoseconds=...)` stands for; None when they are not known."""
    parts = [named[name] for name in ("seconds", "nanoseconds") if name in named]
    scales = [scale for name, scale in (("seconds", 1.0), ("nanoseconds", 1e-9)) if name in named]
    if not all(isinstance(part, Number) for part in parts):
        return None
    total = sum(part.value * scale for part, scale in zip(parts, scales, strict=True) if isinstance(part, Number))
    return Number(total, f"{total:g}")


def _duration(value: Thing) -> float | None:
    """Return a duration in seconds, infinite for rclpy's own `Infinite`; None when it is not known."""
    if isinstance(value, Number):
        return value.value
    name = value.path.rpartition(".")[2] if isinstance(value, Dotted) else ""
    return INFINITE if name == "Infinite" else None


def _policy(value: Thing, field: str) -> str | None:
    """Return the word of `ReliabilityPolicy.BEST_EFFORT` and of its longer spellings, in small letters."""
    if not isinstance(value, Dotted):
        return None
    word = value.path.rpartition(".")[2].lower()
    for prefix in (f"rmw_qos_policy_{field}_", *_PREFIXES):
        word = word.removeprefix(prefix)
    return word
