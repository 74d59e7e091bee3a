"""Names of interfaces whose text comes from a parameter: the part that the parameter gives, and its value.

A fact has the name with the parameter's default in it (`~/front/scan`, of the parameter `~/topic` with the default
`scan`), or a hole with its label where it has none. Where the default is in the name tells which part is the
parameter's.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from kg.facts import Resolution
from kg.holes import PARENT, hole_of, is_partial, partition
from kg.launch.wiring.values import shown
from kg.names import join, normalise

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.facts import Interface, LaunchParameter, NodeType

_MEMBER: Final = re.compile(r"\[(['\"])\w+\1\]|\.get\([^()]*\)")
_PARENT: Final = f"{{{PARENT}}}/"
_HANDLE_UNKNOWN: Final = "the namespace of the node handle is not known"


@dataclass(frozen=True, slots=True)
class Named:
    """A name before namespaces and remappings; None when nothing of it is known."""

    name: str | None
    resolution: Resolution
    parameter: LaunchParameter | None = None
    reason: str | None = None


def _defaults(node: NodeType, parameter: str | None) -> list[str]:
    """Return the texts that a parameter of a node type has by default."""
    found = (shown(one.default) for one in node.parameters if one.name == parameter and one.default is not None)
    return [text for text in found if text is not None]


def named(declared: Interface, node: NodeType, setting: LaunchParameter | None) -> Named:
    """Return the name that an interface of a node type has with `setting` for its parameter."""
    if setting is None:
        return Named(declared.name, declared.resolution, None, declared.reason)
    before, after, sure = _around(declared, _defaults(node, declared.parameter))
    rooted = declared.name is not None and declared.name.startswith("/") and node.language == "cpp"
    if rooted and before + after == "":
        sure = False  # an absolute default hides the namespace of the handle
    value = shown(setting.value)
    if value is None:
        unknown = setting.reason or f"the value of the parameter {setting.name} is not known before run time"
        return Named(_put(before, hole_of(declared.parameter or ""), after), Resolution.PARTIAL, setting, unknown)
    if not value.strip() and not (before + after).strip("/~"):
        empty = f"the parameter {setting.name} is empty"
        return Named(None, Resolution.UNRESOLVED, setting, empty)
    name = _put(before, value.strip(), after)
    if name.startswith("/") and _in_own_namespace(declared, node):
        name = name.lstrip("/")
    if is_partial(name):
        return Named(name, Resolution.PARTIAL, setting, setting.reason or declared.reason)
    if not sure and not name.startswith(("/", "~")):
        return Named(name, Resolution.PARTIAL, setting, _HANDLE_UNKNOWN)
    return Named(name, Resolution.LAUNCH_ARGUMENT, setting)


def _in_own_namespace(declared: Interface, node: NodeType) -> bool:
    """Return whether code puts the node's namespace in front of a value that by default is an absolute name."""
    name = declared.name
    defaults = _defaults(node, declared.parameter) if name is not None and not name.startswith("/") else ()
    return any(text.startswith("/") and normalise(text)[1:] == name for text in defaults)


def _around(declared: Interface, defaults: Iterable[str]) -> tuple[str, str, bool]:
    """Return the text before and after the parameter's part of a name, and whether it is certain."""
    name = declared.name
    if name is None:
        return "", "", not (declared.written or "").strip() or _plain(declared.written)
    if name.startswith(_PARENT):
        before, after, sure = _around(replace(declared, name=name.removeprefix(_PARENT)), defaults)
        return _PARENT + before, after, sure
    own = hole_of(declared.parameter or "")
    before, hole, after = partition(name, own)
    if hole and (hole == own or (declared.parameter or "") in (declared.reason or "")):
        return before, after, True
    texts = sorted({normalise(text) for text in defaults if text}, key=len, reverse=True)
    if name.strip("/~") and "" in defaults and not texts:  # a prefix (`ns + "/scan"`): nothing of it is in the name
        return "", name, True
    for text in texts:
        if name == text:
            return "", "", True
        if name.endswith(f"/{text}"):
            return name.removesuffix(text), "", True
        if name.startswith(text):
            return "", name.removeprefix(text), True
    for text in texts:
        if name.count(text) == 1:
            before, _, after = name.partition(text)
            return before, after, True
    if name.startswith("~/") and _plain(declared.written):
        return f"{name.rpartition('/')[0]}/", "", True
    return "", "", _plain(declared.written)


def _plain(written: str | None) -> bool:
    """Return whether an expression is no more than a variable or a member of one: nothing is joined to its value."""
    bare = _MEMBER.sub("", (written or "").strip())
    return all(char.isalnum() or char in "_.:->()[]" for char in bare)


def _put(before: str, value: str, after: str) -> str:
    """Return the name with a value in its part; an absolute or private value leaves what a handle puts in front."""
    if value.startswith(("/", "~")) and (not before or before.endswith("/")):
        return normalise(value + after)
    if not before.strip("/~") and not before.startswith(("/", "~")):
        return normalise(value + after)
    if before.endswith("/"):
        return join(before, normalise(value + after))
    return normalise(before + value + after)
