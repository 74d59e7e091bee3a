"""Domains of DDS that compare types by their names, as ROS 2 does.

Cyclone DDS compares descriptions of types as well (DDS XTypes), and asks a peer for a description that differs from its
own. The response reaches all participants of the domain, and the Cyclone DDS of ROS 2 up to Jazzy (0.10) crashes on it.
So ours ignores the descriptions that others send. Its own are sent all the same, but nobody of ROS 2 asks for more.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Final

from cyclonedds.core import DDSException
from cyclonedds.domain import Domain, DomainParticipant

from kg.robot.dds.bell import delete
from kg.robot.dds.surroundings import discovery_settings

if TYPE_CHECKING:
    from cyclonedds.core import Qos

__all__ = ["join", "leave"]

_BY_NAME: Final = (
    "<CycloneDDS><Domain><Compatibility><IgnoreTypeInformation>1.1,1.15,1.16</IgnoreTypeInformation>"
    "</Compatibility></Domain></CycloneDDS>"
)
"""The numbers are those of the vendors RTI, eProsima and Eclipse, whose DDS ROS 2 runs on."""
_DOMAINS: Final[dict[int, Domain]] = {}


def join(number: int, qos: Qos, *, by_name: bool) -> DomainParticipant:
    """Become a participant of a domain; its settings are those of the first participant of this process.

    What $CYCLONEDDS_URI says counts more than the variables of ROS. RobotError KG817 for a variable that says nothing.
    """
    reach = discovery_settings(os.environ)
    if (by_name or reach) and number not in _DOMAINS:
        settings = ",".join(one for one in (reach, os.environ.get("CYCLONEDDS_URI"), _BY_NAME * by_name) if one)
        try:
            _DOMAINS[number] = Domain(number, settings)
        except DDSException as error:
            if error.code != DDSException.DDS_RETCODE_PRECONDITION_NOT_MET:  # somebody else in this process is in it
                raise
    return DomainParticipant(number, qos=qos)


def leave(number: int, participant: DomainParticipant) -> None:
    """Delete a participant, and the domain with the last one."""
    delete(participant)
    if number in _DOMAINS and not _DOMAINS[number].get_participants():
        delete(_DOMAINS.pop(number))
