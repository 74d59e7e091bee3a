"""DDS domains: the range of discovery, and the comparison of types.

ROS_AUTOMATIC_DISCOVERY_RANGE is SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT, ROS_STATIC_PEERS lists further hosts, and
ROS_LOCALHOST_ONLY=1 is their predecessor (docs.ros.org, "Improved dynamic discovery"). They are converted to the same
settings of Cyclone DDS as by rmw_cyclonedds_cpp (`check_create_domain`).

ROS 2 compares types by name. Cyclone DDS also compares descriptions of types (DDS XTypes), and requests differing ones
from peers. The response reaches all participants of the domain, and Cyclone DDS of ROS 2 up to Jazzy (0.10) crashes on
it. So kg ignores descriptions of others. It sends its own, but no ROS 2 node requests more.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Final
from xml.sax.saxutils import quoteattr

from cyclonedds.core import DDSException, Qos
from cyclonedds.domain import Domain, DomainParticipant

from kg.errors import RobotError
from kg.robot.dds.entities import delete

_RANGES = ("SUBNET", "LOCALHOST", "OFF", "SYSTEM_DEFAULT")


def discovery_settings(environment: Mapping[str, str]) -> str:
    """Return the settings for environment variables, empty without any; RobotError KG817 an unknown range."""
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
        discovery = f"<ParticipantIndex>none</ParticipantIndex><Tag>ros_discovery_off_{os.getpid()}</Tag>"
    else:
        hosts = (["localhost"] if reach == "LOCALHOST" else []) + peers
        listed = "".join(f"<Peer address={quoteattr(one)}/>" for one in hosts)
        discovery = "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
        discovery += f"<Peers>{listed}</Peers>" if listed else ""
    quiet = "<General><AllowMulticast>false</AllowMulticast></General>" if reach in {"LOCALHOST", "OFF"} else ""
    return f"<CycloneDDS><Domain>{quiet}<Discovery>{discovery}</Discovery></Domain></CycloneDDS>"


_BY_NAME: Final = (
    "<CycloneDDS><Domain><Compatibility><IgnoreTypeInformation>1.1,1.15,1.16</IgnoreTypeInformation>"
    "</Compatibility></Domain></CycloneDDS>"
)
"""The numbers are those of the vendors RTI, eProsima and Eclipse, whose DDS ROS 2 uses."""
_DOMAINS: Final[dict[int, Domain]] = {}


def join(number: int, qos: Qos, *, by_name: bool) -> DomainParticipant:
    """Join a domain as a participant; its settings are those of the first participant of this process.

    $CYCLONEDDS_URI overrides the variables of ROS. RobotError KG817 for an invalid variable.
    """
    reach = discovery_settings(os.environ)
    if (by_name or reach) and number not in _DOMAINS:
        settings = ",".join(one for one in (reach, os.environ.get("CYCLONEDDS_URI"), _BY_NAME * by_name) if one)
        try:
            _DOMAINS[number] = Domain(number, settings)
        except DDSException as error:
            if error.code != DDSException.DDS_RETCODE_PRECONDITION_NOT_MET:  # another connection uses it
                raise
    return DomainParticipant(number, qos=qos)


def leave(number: int, participant: DomainParticipant) -> None:
    """Delete a participant, and its domain with the last one."""
    delete(participant)
    if number in _DOMAINS and not _DOMAINS[number].get_participants():
        delete(_DOMAINS.pop(number))
