"""Names of ROS 2 and their forms in DDS, and in Zenoh, which uses the same names of types.

Source: design.ros2.org/articles/topic_and_service_names.html for the form of names and the prefixes `rt`, `rq`, `rr`.
Types have `dds_` as their last module and an underscore as suffix.
"""

from __future__ import annotations

import re
from typing import Final

from kg.errors import RobotError
from kg.facts import Role

_NAME: Final = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")
_TYPE: Final = re.compile(r"([A-Za-z]\w*)::(?:msg|srv|action)::dds_::([A-Za-z]\w*)_", re.ASCII)
_ACTION: Final = re.compile(
    r"_(?:SendGoal|GetResult)(?:_(?:Request|Response|Event))?$|_(?:Goal|Result|Feedback|FeedbackMessage)$"
)
_SERVICE: Final = re.compile(r"_(?:Request|Response|Event)$")
_LONGEST: Final = 255


def is_name(name: str) -> bool:
    """Return whether a text is the absolute name of a node, topic or service."""
    return len(name) <= _LONGEST and _NAME.fullmatch(name) is not None and "__" not in name


def absolute(name: str) -> str:
    """Return an absolute name for our own node; RobotError KG801 for an invalid one."""
    full = name if name.startswith("/") else f"/{name}"
    if not is_name(full):
        hint = "Write letters, digits and underscores between slashes."
        raise RobotError("KG801", f"`{name}` is not a ROS 2 node name", hint=hint)
    return full


def family(kind: str, *, service: bool = False) -> str:
    """Return the folder of its package in which a type is defined: `msg`, `srv` or `action`.

    The name alone determines it, since only parts of services and actions contain an underscore; `service` marks the
    type of a whole service, which has none.
    """
    if _ACTION.search(kind):
        return "action"
    return "srv" if service or _SERVICE.search(kind) else "msg"


def full_type(kind: str, *, service: bool = False) -> str:
    """Return the full name of `package/Type`: `package/msg/Type`, also with `srv` or `action`."""
    package, _, name = kind.partition("/")
    return f"{package}/{family(kind, service=service)}/{name}"


def dds_type(kind: str, *, service: bool = False) -> str:
    """Return the DDS name of `package/Type`: `package::msg::dds_::Type_`."""
    package, folder, name = full_type(kind, service=service).split("/")
    return f"{package}::{folder}::dds_::{name}_"


def ros_type(mangled: str) -> str | None:
    """Return `package/Type` for a DDS type name, None if it is not a ROS type."""
    match = _TYPE.fullmatch(mangled)
    return f"{match[1]}/{match[2]}" if match else None


def dds_topic(name: str, role: Role) -> str:
    """Return the DDS topic of a ROS name; for a service that of its requests."""
    if role.channel == "service":
        return f"rq{name}Request"
    return f"rt{name}"


def replies(service: str) -> str:
    """Return the DDS topic of the responses of a service."""
    return f"rr{service}Reply"


def ros_end(topic: str, mangled: str, *, writer: bool) -> tuple[Role, str, str | None] | None:
    """Return role, name and type of the ROS end of a DDS reader or writer; None if there is none.

    Responses are ignored: the reader of requests is the server, the writer is a client.
    """
    kind = ros_type(mangled)
    if topic.startswith("rt/"):
        return (Role.PUBLISHES if writer else Role.SUBSCRIBES), topic[2:], kind
    if topic.startswith("rq/") and topic.endswith("Request"):
        service = kind.removesuffix("_Request") if kind else None
        return (Role.CLIENTS if writer else Role.SERVICES), topic[2 : -len("Request")], service
    return None
