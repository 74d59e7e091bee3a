"""Conversion between quality of service of ROS and of DDS."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from typing import Any, Final

from cyclonedds.core import Policy
from cyclonedds.core import Qos as DdsQos
from cyclonedds.internal import dds_c_t
from cyclonedds.qos import _CQos
from cyclonedds.util import duration

from kg.facts import Qos

_POLICIES: Final[Any] = _CQos
_STRUCTURE: Final[Any] = dds_c_t.qos_p
_READ: Final = ("reliability", "durability", "deadline", "history", "lifespan", "liveliness", "userdata", "property")

_BLOCKING: Final = duration(milliseconds=100)
"""Maximum time that writing waits for slow readers; it blocks the event loop."""
_COERCION: Final = Policy.TypeConsistency.AllowTypeCoercion(
    ignore_sequence_bounds=True,
    ignore_string_bounds=True,
    ignore_member_names=True,
    prevent_type_widening=False,
    force_type_validation=False,
)
"""ROS 2 compares names of types, and since Iron their hashes; not the type information of DDS XTypes, which most of
its middlewares do not send.
"""
_INFINITE: Final = (1 << 63) - 1
_UNLIMITED: Final = -1


def to_dds(qos: Qos, data: Mapping[str, str]) -> DdsQos:
    """Return the policies for a reader or writer; `data` is announced as its user data."""
    history = Policy.History.KeepAll if qos.history == "keep_all" else Policy.History.KeepLast(max(qos.depth or 1, 1))
    policies = [
        Policy.Reliability.BestEffort if qos.reliability == "best_effort" else Policy.Reliability.Reliable(_BLOCKING),
        history,
        Policy.Userdata(written(data)),
        Policy.DataRepresentation(use_cdrv0_representation=True),
        Policy.WriterDataLifecycle(autodispose=False),
        _COERCION,
    ]
    if qos.durability == "transient_local":
        policies.append(Policy.Durability.TransientLocal)
        limits = (_UNLIMITED, _UNLIMITED, _UNLIMITED)
        policies.append(Policy.DurabilityService(0, history, *limits))
    if qos.lifespan is not None:
        policies.append(Policy.Lifespan(duration(seconds=qos.lifespan)))
    return DdsQos(*policies)


def written(data: Mapping[str, str]) -> bytes:
    """Return user data in the format of ROS 2: `key=value;` repeated."""
    return "".join(f"{key}={value};" for key, value in data.items()).encode()


def user_data(qos: DdsQos) -> dict[str, str]:
    """Return announced user data; parts not of the form `key=value;` are ignored."""
    policy = _policy(qos, Policy.Userdata)
    if policy is None:
        return {}
    parts = (part.partition("=") for part in policy.data.decode("utf-8", "replace").split(";"))
    return {key: value for key, sign, value in parts if sign}


def policies_at(pointer: int) -> DdsQos:
    """Return the policies that we use from the library's description of another end."""
    structure = ctypes.cast(pointer, _STRUCTURE)
    read = (getattr(_POLICIES, f"_get_p_{name}")(structure) for name in _READ)
    policies = (one if isinstance(one, list) else [one] for one in read if one is not None)
    return DdsQos(*(policy for each in policies for policy in each))


def from_dds(qos: DdsQos, *, writer: bool, cyclone: bool = False) -> Qos:
    """Return the quality of service of another node's end.

    History and depth are not part of DDS discovery, but Cyclone DDS sends them to its own kind. For peers of other
    vendors the library returns its default, which means nothing, so they are read with `cyclone` only.
    """
    liveliness = _policy(qos, Policy.Liveliness)
    history = _policy(qos, Policy.History) if cyclone else None
    return Qos(
        reliability="best_effort" if _policy(qos, Policy.Reliability) == Policy.Reliability.BestEffort else "reliable",
        durability="volatile" if _policy(qos, Policy.Durability) == Policy.Durability.Volatile else "transient_local",
        history=None if history is None else "keep_all" if history == Policy.History.KeepAll else "keep_last",
        depth=getattr(history, "depth", None),
        deadline=_seconds(_policy(qos, Policy.Deadline), "deadline"),
        lifespan=_seconds(_policy(qos, Policy.Lifespan), "lifespan") if writer else None,
        liveliness="manual_by_topic" if isinstance(liveliness, Policy.Liveliness.ManualByTopic) else "automatic",
        lease_duration=_seconds(liveliness, "lease_duration"),
    )


def _policy(qos: DdsQos, policy: Any) -> Any:
    if policy not in qos:
        return None
    return qos[policy]


def _seconds(policy: Any, field: str) -> float | None:
    nanoseconds = getattr(policy, field, None)
    return None if nanoseconds is None or nanoseconds >= _INFINITE else nanoseconds / 1e9
