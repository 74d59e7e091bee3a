"""Quality of service: profiles, and how constructors, methods and assignments to fields change them.

A profile of rclcpp has the native value `qos`. One of rmw is a struct: its fields hold the policies. A profile with any
unknown part is unknown as a whole. Sources: rclcpp/qos.hpp, rmw/qos_profiles.h, rmw/types.h.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

from kg.facts import Qos
from kg.symbolic.durations import INFINITE, duration, seconds_of
from kg.symbolic.values import ABSENT, Enumerator, Kind, Number, Object, Profile, Sequence, Text, Unknown, Value, number

if TYPE_CHECKING:
    from kg.symbolic.machine import Machine

RMW_PROFILE: Final = "rmw_qos_profile_t"
PYTHON_PROFILE: Final = "QoSProfile"
_DEFAULT: Final = Qos("reliable", "volatile", "keep_last", 10)
_SENSOR: Final = Qos("best_effort", "volatile", "keep_last", 5)
_PARAMETERS: Final = Qos("reliable", "volatile", "keep_last", 1000)
_CLASSES: Final[dict[str, Qos]] = {
    "SensorDataQoS": _SENSOR,
    "SystemDefaultsQoS": Qos(),
    "BestAvailableQoS": Qos(),
    "ServicesQoS": _DEFAULT,
    "ParametersQoS": _PARAMETERS,
    "ParameterEventsQoS": _PARAMETERS,
    "ClockQoS": Qos("best_effort", "volatile", "keep_last", 1),
    "RosoutQoS": Qos("reliable", "transient_local", "keep_last", 1000),
    "DynamicBroadcasterQoS": Qos("reliable", "volatile", "keep_last", 100),
    "DynamicListenerQoS": Qos("reliable", "volatile", "keep_last", 100),
    "StaticBroadcasterQoS": Qos("reliable", "transient_local", "keep_last", 1),
    "StaticListenerQoS": Qos("reliable", "transient_local", "keep_last", 100),
}
PROFILES: Final = {
    "rmw_qos_profile_sensor_data": _SENSOR,
    "rmw_qos_profile_default": _DEFAULT,
    "rmw_qos_profile_services_default": _DEFAULT,
    "rmw_qos_profile_parameters": _PARAMETERS,
    "rmw_qos_profile_parameter_events": _PARAMETERS,
    "rmw_qos_profile_system_default": Qos(),
    "rmw_qos_profile_best_available": Qos(),
}
_POLICIES: Final = {
    "history": {"keep_last", "keep_all"},
    "reliability": {"reliable", "best_effort"},
    "durability": {"volatile", "transient_local"},
    "liveliness": {"automatic", "manual_by_topic"},
}
_UNSPECIFIED: Final = {"system_default", "best_available", "unknown"}
_NUMBERED: Final = {
    "history": ("system_default", "keep_last", "keep_all"),
    "reliability": ("system_default", "reliable", "best_effort"),
    "durability": ("system_default", "transient_local", "volatile"),
    "liveliness": ("system_default", "automatic", "manual_by_node", "manual_by_topic"),
}
"""The enumerators of each policy by their number (rmw/types.h)."""
_DURATIONS: Final = {
    "deadline": "deadline",
    "lifespan": "lifespan",
    "liveliness_lease_duration": "lease_duration",
}
"""Methods of rclcpp::QoS and fields of rmw_qos_profile_t that hold a duration, with the fields of `Qos`."""
_FIELDS: Final = (
    "history",
    "depth",
    "reliability",
    "durability",
    "deadline",
    "lifespan",
    "liveliness",
    "liveliness_lease_duration",
)
"""The fields of rmw_qos_profile_t, in order."""
_OF_PYTHON: Final = ("depth", *(name for name in _FIELDS if name != "depth"))
"""The fields of rclpy's QoSProfile, in the order of its description."""
_STRUCTS: Final = (RMW_PROFILE, PYTHON_PROFILE)
"""Classes whose objects hold the policies in fields."""
_SETTERS: Final[dict[str, dict[str, Any]]] = {
    "reliable": {"reliability": "reliable"},
    "best_effort": {"reliability": "best_effort"},
    "reliability_best_available": {"reliability": None},
    "transient_local": {"durability": "transient_local"},
    "durability_volatile": {"durability": "volatile"},
    "durability_best_available": {"durability": None},
    "keep_all": {"history": "keep_all", "depth": None},
    "avoid_ros_namespace_conventions": {},
}
METHODS: Final = frozenset({*_SETTERS, *_FIELDS, "keep_last", "get_rmw_qos_profile"})
_POLICY: Final = re.compile(r"RMW_QOS_POLICY_(HISTORY|RELIABILITY|DURABILITY|LIVELINESS)_(\w+)")
_POLICY_CLASSES: Final = {f"{name.capitalize()}Policy": name for name in _POLICIES}
_CAPITAL: Final = re.compile(r"(?<=[a-z])(?=[A-Z])")


def policy(names: tuple[str, ...]) -> Enumerator | None:
    """Return the policy of an enumerator: `rclcpp::DurabilityPolicy::TransientLocal`, `RMW_QOS_POLICY_...`."""
    match = _POLICY.fullmatch(names[-1])
    if match is not None:
        of, name = match[1].lower(), match[2].lower()
    elif len(names) > 1 and names[-2] in _POLICY_CLASSES:
        of, name = _POLICY_CLASSES[names[-2]], _CAPITAL.sub("_", names[-1]).lower()
    else:
        return None
    numbers = _NUMBERED[of]
    return Enumerator(name, number=numbers.index(name) if name in numbers else None)


def rmw_profile(qos: Qos) -> Object:
    """Return a struct of rmw with the policies of a profile."""
    fields: dict[str, Value] = {name: value for name in _FIELDS if (value := _field(qos, name)) is not None}
    return Object(Kind((RMW_PROFILE,)), fields=fields)


def _field(qos: Qos, name: str) -> Value | None:
    """Return a policy of a profile as a value; None if it is left to the default."""
    if name in _DURATIONS:
        return duration(getattr(qos, _DURATIONS[name]) or 0.0)
    setting: str | int | None = getattr(qos, name)
    return Text.of(setting) if isinstance(setting, str) else number(setting) if setting is not None else None


def construct(instance: Object, kind: Kind, arguments: list[Value]) -> None:
    """Initialise a profile as its constructor does."""
    if kind.name == PYTHON_PROFILE:
        given = {name: value for name, value in zip(_OF_PYTHON, arguments, strict=False) if value is not ABSENT}
        if not isinstance(given.get("depth"), Number):
            given.pop("depth", None)
        instance.fields.update(rmw_profile(replace(_DEFAULT, depth=None)).fields | given)
    elif kind.name == RMW_PROFILE:
        instance.fields.update(rmw_profile(Qos()).fields | dict(zip(_FIELDS, arguments, strict=False)))
    else:
        instance.native["qos"] = Profile(_constructed(kind.name, arguments))


def _constructed(name: str, arguments: list[Value]) -> Qos | None:
    """Return the profile that a constructor of rclcpp makes: of a depth, a history, or two profiles.

    Of two profiles, the first has history and depth, the second all other policies.
    """
    history = _enumerator("history", arguments[0]) if arguments and not isinstance(arguments[0], Number) else None
    if name == "KeepAll" or history == "keep_all":
        return replace(_DEFAULT, history="keep_all", depth=None)
    if history is not None:
        arguments = arguments[1:2]
    start = profile_of(arguments[0]) if arguments else None
    if len(arguments) < 2:  # noqa: PLR2004 - two profiles
        base = _CLASSES.get(name)
        if base is None or not arguments:
            return start if arguments else base
    else:
        base = profile_of(arguments[1])
    return replace(base, history=start.history, depth=start.depth) if base is not None and start is not None else None


def profile_of(value: Value) -> Qos | None:
    """Return the profile of an argument: a depth, or a profile of rclcpp or rmw; None if any part is unknown."""
    if isinstance(value, Number):
        return replace(_DEFAULT, depth=value.whole)
    if isinstance(value, Sequence):
        return _constructed("QoS", list(value.items))
    if not isinstance(value, Object):
        return None
    if value.kind.name in _STRUCTS:
        return with_fields(Qos(), {name: value.fields[name] for name in _FIELDS if name in value.fields})
    profile = value.native.get("qos")
    return profile.qos if isinstance(profile, Profile) else None


def changed_profile(machine: Machine, of: Object, name: str, arguments: list[Value]) -> Value | None:
    """Return the result of a method of a profile; None for unknown methods."""
    if name not in METHODS:
        return None
    qos = profile_of(of)
    if name in _FIELDS and not arguments:
        return (_field(qos, name) if qos is not None else None) or Unknown("the quality of service is unknown")
    if name == "get_rmw_qos_profile":
        return rmw_profile(qos) if qos is not None else Unknown("the quality of service is unknown")
    if qos is not None and name in _SETTERS:
        qos = replace(qos, **_SETTERS[name])
    elif qos is not None:
        changes = {"history": Text.of("keep_last"), "depth": arguments[0]} if name == "keep_last" and arguments else {}
        qos = with_fields(qos, changes or {name: arguments[0]}) if arguments else None
    machine.write(of.native, "qos", Profile(qos))
    return of


def with_fields(qos: Qos, fields: dict[str, Value]) -> Qos | None:
    """Return a profile with changed policies; None if any of them is unknown.

    A duration of zero means the default, which is none (RMW_DURATION_UNSPECIFIED in rmw/types.h).
    """
    changes: dict[str, Any] = {}
    for name, value in fields.items():
        seconds, policy_name = seconds_of(value), _enumerator(name, value)
        if name == "depth" and isinstance(value, Number):
            changes["depth"] = value.whole
        elif policy_name is not None and policy_name in _POLICIES[name] | _UNSPECIFIED:
            changes[name] = policy_name if policy_name in _POLICIES[name] else None
        elif name in _DURATIONS and seconds is not None:
            changes[_DURATIONS[name]] = seconds if 0 < seconds < INFINITE else None
        else:
            return None
    return replace(qos, **changes)


def _enumerator(name: str, value: Value) -> str | None:
    """Return the enumerator of a policy that a value is, or that has its number."""
    if isinstance(value, Number) and name in _NUMBERED:
        return dict(enumerate(_NUMBERED[name])).get(value.whole)
    if name not in _POLICIES:
        return None
    return value.name if isinstance(value, Enumerator) else value.exact if isinstance(value, Text) else None
