"""Bags that tests write with `rosbags`: ROS 1 (`.bag`) and ROS 2 (`.mcap`, `.db3`)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2

from kg.robot.messages import Types
from kg.robot.ros2.types import type_hash

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["BEGUN", "FORMS", "Sent", "odometry", "write"]

BEGUN = 1_700_000_000
"""Start of the recordings, in seconds since 1970."""
FORMS = ("bag", "mcap", "db3")


@dataclass(frozen=True)
class Sent:
    """A message to record: its time in seconds and its sender."""

    topic: str
    type: str
    at: float
    value: dict[str, Any] = field(default_factory=dict)
    node: str | None = "/base"
    latched: bool = False


def odometry(number: int, every: float = 0.01) -> list[Sent]:
    """Return messages of /odom, one metre apart."""
    return [
        Sent("/odom", "nav_msgs/Odometry", one * every, {"pose": {"pose": {"position": {"x": float(one)}}}})
        for one in range(number)
    ]


def write(folder: Path, form: str, messages: list[Sent], types: Types | None = None) -> str:
    """Write a bag of one of `FORMS`, and return its address."""
    ordered = sorted(messages, key=lambda one: one.at)
    known = types or Types(1 if form == "bag" else 2)
    if form == "bag":
        _write1(folder / "drive.bag", ordered, known)
        return f"bag://{folder}/drive.bag"
    storage = StoragePlugin.MCAP if form == "mcap" else StoragePlugin.SQLITE3
    with Writer2(folder / "drive", version=9, storage_plugin=storage) as writer:
        channels: dict[str, Any] = {}
        for one in ordered:
            if one.topic not in channels:
                channels[one.topic] = writer.add_connection(
                    one.topic,
                    one.type.replace("/", "/msg/"),
                    msgdef=known.definition(one.type),
                    rihs01=type_hash(known, one.type),
                    offered_qos_profiles=[_qos(latched=one.latched)],
                )
            writer.write(channels[one.topic], _stamp(one), known.encode(one.type, one.value))
    return f"bag://{folder}/drive/drive.{form}"


def _write1(path: Path, messages: list[Sent], types: Types) -> None:
    with Writer1(path) as writer:
        channels: dict[Any, Any] = {}
        for one in messages:
            key = one.topic, one.node
            if key not in channels:
                channels[key] = writer.add_connection(
                    one.topic,
                    one.type.replace("/", "/msg/"),
                    msgdef=types.definition(one.type),
                    md5sum=types.md5(one.type),
                    callerid=one.node,
                    latching=int(one.latched),
                )
            writer.write(channels[key], _stamp(one), types.encode(one.type, one.value))


def _stamp(one: Sent) -> int:
    return BEGUN * 10**9 + round(one.at * 1e9)


def _qos(*, latched: bool) -> Qos:
    durability = QosDurability.TRANSIENT_LOCAL if latched else QosDurability.VOLATILE
    never = QosTime(2**31 - 1, 0)
    return Qos(
        QosHistory.KEEP_LAST,
        7,
        QosReliability.RELIABLE,
        durability,
        never,
        never,
        QosLiveliness.AUTOMATIC,
        never,
        False,
    )
