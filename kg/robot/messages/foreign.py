"""Definitions of types as recordings and bridges tell them: `.msg` texts with names of ROS 2, and IDL."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from rosbags.typesys import Stores, get_types_from_idl, get_typestore

from kg.errors import RobotError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.robot.messages import Types

__all__ = ["learn", "learn_all", "short"]

_HEADING: Final = re.compile(r"^(MSG: \w+)/msg/", re.MULTILINE)
_FAMILY: Final = re.compile(r"/(?:msg|srv|action)/")
_SEPARATOR: Final = "=" * 80 + "\n"


def short(kind: str) -> str:
    """Return `package/Type` for the name of a type in ROS 2 (`package/msg/Type`) or ROS 1."""
    return _FAMILY.sub("/", kind)


def learn(types: Types, kind: str, text: str, *, idl: bool = False) -> None:
    """Learn a type by its definition with those it uses; RobotError as `Types.define`."""
    types.define(kind, _HEADING.sub(r"\1/", _of_idl(kind, text) if idl else text))


def learn_all(types: Types, texts: Mapping[str, str]) -> None:
    """Learn types that use each other by their definitions in `.msg` form; those that are known stay as they are.

    Raises as `Types.define`.
    """
    new = {name: text for name, text in texts.items() if not types.knows(name)}
    for name, own in new.items():
        others = (f"{_SEPARATOR}MSG: {one}\n{text}" for one, text in new.items() if one != name)
        types.define(name, own + "".join(others))


def _of_idl(kind: str, text: str) -> str:
    """Return the definition of a type in `.msg` form; RobotError KG810 for IDL that cannot be read."""
    store = get_typestore(Stores.EMPTY)
    try:
        parts = (
            [one.partition("\n")[2] for one in text.split(_SEPARATOR)[1:]] if text.startswith(_SEPARATOR) else [text]
        )
        for part in parts:
            store.register(get_types_from_idl(part))
        return store.generate_msgdef(kind.replace("/", "/msg/"), ros_version=2)[0]
    except Exception as error:  # noqa: BLE001 - the grammar raises errors of several kinds
        raise RobotError("KG810", f"the definition of `{kind[:80]}` cannot be read: {error}") from None
