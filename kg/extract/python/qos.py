"""Quality of service of ROS 2 in Python: profiles, presets, a plain depth.

Source: the presets of `rclpy.qos` (rmw/qos_profiles.h). What a profile leaves out is what rclpy's QoSProfile leaves
to the default profile: reliable, volatile, keep last.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.extract.python.entities import Dotted, QosValue
from kg.extract.values import Number
from kg.facts import Qos

if TYPE_CHECKING:
    from kg.extract.python.entities import Thing

__all__ = ["changed", "preset", "quality", "read_qos"]

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

_FIELDS: Final = ("reliability", "durability", "history")
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


def read_qos(values: list[Thing], named: dict[str, Thing]) -> Qos:
    """Return the profile that `QoSProfile(...)` makes of its arguments."""
    depth = named.get("depth", values[0] if values else None)
    fields = {name: _policy(named[name], name) for name in _FIELDS if name in named}
    return Qos(
        reliability=fields.get("reliability", _DEFAULT.reliability),
        durability=fields.get("durability", _DEFAULT.durability),
        history=fields.get("history", _DEFAULT.history),
        depth=int(depth.value) if isinstance(depth, Number) else None,
    )


def changed(qos: Qos, values: dict[str, Thing]) -> Qos:
    """Return a profile with some of its fields given other values."""
    depth = values.get("depth")
    policies = {name: _policy(value, name) for name, value in values.items() if name != "depth"}
    return replace(qos, **policies, depth=int(depth.value) if isinstance(depth, Number) else qos.depth)


def _policy(value: Thing, field: str) -> str | None:
    """Return the word of `ReliabilityPolicy.BEST_EFFORT` and of its longer spellings, in small letters."""
    if not isinstance(value, Dotted):
        return None
    word = value.path.rpartition(".")[2].lower()
    for prefix in (f"rmw_qos_policy_{field}_", *_PREFIXES):
        word = word.removeprefix(prefix)
    return word
