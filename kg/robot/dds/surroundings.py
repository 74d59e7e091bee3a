"""How far nodes of ROS 2 look for others, by its environment variables, as settings of Cyclone DDS.

ROS_AUTOMATIC_DISCOVERY_RANGE is SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT, ROS_STATIC_PEERS lists hosts that are asked
besides, and ROS_LOCALHOST_ONLY=1 is what they replace (docs.ros.org, "Improved dynamic discovery"). The settings are
those that rmw_cyclonedds_cpp makes of them (`check_create_domain`).
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

from kg.errors import RobotError

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["discovery_settings"]

_RANGES = ("SUBNET", "LOCALHOST", "OFF", "SYSTEM_DEFAULT")


def discovery_settings(environment: Mapping[str, str]) -> str:
    """Return the settings that variables ask for, empty where none does.

    Raises:
        RobotError: KG817 for a range that there is not.
    """
    reach = environment.get("ROS_AUTOMATIC_DISCOVERY_RANGE") or ""
    peers = [one.strip() for one in (environment.get("ROS_STATIC_PEERS") or "").split(";") if one.strip()]
    if environment.get("ROS_LOCALHOST_ONLY") == "1":
        reach, peers = "LOCALHOST", []
    if reach and reach not in _RANGES:
        hint = f"Valid: {', '.join(_RANGES)}."
        raise RobotError("KG817", f"ROS_AUTOMATIC_DISCOVERY_RANGE is `{reach}`", hint=hint)
    if reach == "SYSTEM_DEFAULT" or not (reach or peers):
        return ""
    if reach == "OFF":
        found = f"<ParticipantIndex>none</ParticipantIndex><Tag>ros_discovery_off_{os.getpid()}</Tag>"
    else:
        hosts = (["localhost"] if reach == "LOCALHOST" else []) + peers
        listed = "".join(f"<Peer address={quoteattr(one)}/>" for one in hosts)
        found = "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
        found += f"<Peers>{listed}</Peers>" if listed else ""
    quiet = "<General><AllowMulticast>false</AllowMulticast></General>" if reach in {"LOCALHOST", "OFF"} else ""
    return f"<CycloneDDS><Domain>{quiet}<Discovery>{found}</Discovery></Domain></CycloneDDS>"
