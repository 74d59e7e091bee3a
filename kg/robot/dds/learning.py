"""Types that peers tell: descriptions of DDS XTypes as definitions of message types."""

from __future__ import annotations

import asyncio
import typing
from typing import TYPE_CHECKING, Any, Final

from cyclonedds.core import DDSException
from cyclonedds.dynamic import get_types_for_typeid
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, bounded_str, sequence
from cyclonedds.util import duration

from kg.errors import RobotError
from kg.robot.dds.classes import HEADER
from kg.robot.messages.foreign import learn_all
from kg.robot.messages.values import MEMBER_OF_NOTHING
from kg.robot.ros2.names import ros_type

if TYPE_CHECKING:
    from cyclonedds.domain import DomainParticipant

    from kg.robot.messages import Types

__all__ = ["definition", "learned"]

_WAIT: Final = duration(seconds=1)
_PLAIN: Final[dict[Any, str]] = {bool: "bool", str: "string"}


async def learned(participant: DomainParticipant, type_id: Any, types: Types) -> bool:
    """Ask for the description of a type and learn it with all that it uses; tell whether that succeeded.

    The library waits for answers of peers, so that it is asked in a thread.
    """
    try:
        _, found = await asyncio.to_thread(get_types_for_typeid, participant, type_id, _WAIT)
        learn_all(types, dict(map(definition, found.values())))
    except (DDSException, RobotError, TypeError, ValueError):
        return False
    return True


def definition(sort: Any) -> tuple[str, str]:
    """Return the name and the text of the definition of a message; TypeError for what ROS 2 does not have.

    The header of a request or response is none of the service's own, and is left out.
    """
    hints = typing.get_type_hints(sort, include_extras=True)
    if _name(sort).endswith(("_Request", "_Response")) and [*hints][: len(HEADER)] == [*HEADER]:
        hints = dict([*hints.items()][len(HEADER) :])
    lines = [f"{_written(hint)} {name}\n" for name, hint in hints.items() if name != MEMBER_OF_NOTHING]
    return _name(sort), "".join(lines)


def _name(sort: Any) -> str:
    name = ros_type(sort.__idl_typename__.replace(".", "::"))
    if name is None:
        raise TypeError(sort.__idl_typename__)
    return name


def _written(hint: Any) -> str:
    inner = hint.__metadata__[0] if hasattr(hint, "__metadata__") else hint
    if isinstance(inner, sequence):
        limit = f"<={inner.max_length}" if inner.max_length else ""
        return f"{_written(inner.subtype)}[{limit}]"
    if isinstance(inner, array):
        return f"{_written(inner.subtype)}[{inner.length}]"
    if isinstance(inner, bounded_str):
        return f"string<={inner.max_length}"
    if isinstance(inner, str):
        return inner
    if inner in _PLAIN:
        return _PLAIN[inner]
    if isinstance(inner, type) and issubclass(inner, IdlStruct):
        return _name(inner)
    raise TypeError(inner)
