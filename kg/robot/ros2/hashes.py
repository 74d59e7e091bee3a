"""Type hashes, by which peers see that they mean the same type: RIHS01, the SHA-256 of a type's description.

Source: REP 2016 (type description, RIHS01). A service has a description of its own, with a request, a response and an
event, which is made here, since nobody writes it down.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

from kg.robot.messages.values import MEMBER_OF_NOTHING
from kg.robot.ros2.names import family

if TYPE_CHECKING:
    from kg.robot.messages import Field, Types

__all__ = ["type_hash"]

_EVENT: Final = "service_msgs/ServiceEventInfo"
_DUMMY: Final = (MEMBER_OF_NOTHING, (Nodetype.BASE, ("uint8", 0)))


def type_hash(types: Types, kind: str, *, service: bool = False) -> str:
    """Return `RIHS01_` and 64 digits for a message or a service; RobotError KG804 when a type in it is not known."""
    store = get_typestore(Stores.EMPTY)
    found: dict[str, Any] = {}
    if service:
        _describe_service(types, kind, found)
    else:
        _describe(types, kind, found)
    store.fielddefs = found
    return store.hash_rihs01(_full(kind, service=service))


def _full(kind: str, *, service: bool = False) -> str:
    package, _, name = kind.partition("/")
    return f"{package}/{family(kind, service=service)}/{name}"


def _describe(types: Types, kind: str, found: dict[str, Any]) -> None:
    if _full(kind) in found:
        return
    fields = types.fields(kind)
    found[_full(kind)] = ([], [(one.name, _description(one)) for one in fields] or [_DUMMY])
    for one in fields:
        if one.is_message:
            _describe(types, one.type, found)


def _description(field: Field) -> Any:
    sort = Nodetype.NAME if field.is_message else Nodetype.BASE
    base = "uint8" if field.type == "char" else field.type  # rosidl makes a `uint8` of it
    element = (sort, _full(field.type) if field.is_message else (base, field.bound))
    if field.length is None:
        return element
    return (Nodetype.ARRAY, (element, field.length)) if field.length else (Nodetype.SEQUENCE, (element, field.most))


def _describe_service(types: Types, kind: str, found: dict[str, Any]) -> None:
    parts = [(name, f"{kind}_{name.capitalize()}") for name in ("request", "response")]
    for one in (*(part for _, part in parts), _EVENT):
        _describe(types, one, found)
    event: list[Any] = [("info", (Nodetype.NAME, _full(_EVENT)))]
    event += [(name, (Nodetype.SEQUENCE, ((Nodetype.NAME, _full(part)), 1))) for name, part in parts]
    found[_full(f"{kind}_Event")] = ([], event)
    whole: list[Any] = [(f"{name}_message", (Nodetype.NAME, _full(part))) for name, part in parts]
    whole.append(("event_message", (Nodetype.NAME, _full(f"{kind}_Event"))))
    found[_full(kind, service=True)] = ([], whole)
