"""Definitions of message types as texts: their lines, and the sum over them that ROS 1 peers compare.

The text form is that of `.msg` files (wiki.ros.org/msg and the article on interfaces of ROS 2's documentation); what a
publisher of ROS 1 tells holds several of them, behind lines of `=` that the name `MSG: package/Type` follows.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from rosbags.interfaces import Nodetype

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["Definition", "Line", "is_type", "read", "split", "sum_text"]

_BASE: Final = frozenset(
    (
        "bool",
        "byte",
        "char",
        "float32",
        "float64",
        "string",
        *(f"{u}int{n}" for u in ("", "u") for n in (8, 16, 32, 64)),
    )
)
_TIMES: Final = {"time": "builtin_interfaces/Time", "duration": "builtin_interfaces/Duration"}
_TYPE: Final = re.compile(r"[A-Za-z][A-Za-z0-9_]*/[A-Za-z][A-Za-z0-9_]*")
_CONSTANT: Final = re.compile(r"([a-z0-9]+)(?:<=\d+)?\s+([A-Za-z]\w*)\s*=\s*(.*)", re.ASCII)
_FIELD: Final = re.compile(
    r"((?:[A-Za-z]\w*/)?[A-Za-z]\w*)(?:<=(\d+))?(?:\[(<=)?(\d*)\])?\s+([A-Za-z]\w*)(?:\s+\S.*)?", re.ASCII
)
_SEPARATOR: Final = re.compile(r"^={20,}[ \t]*$", re.MULTILINE)
_MOST_CHARACTERS: Final = 1 << 18
_MOST_ELEMENTS: Final = 1 << 22


@dataclass(frozen=True, slots=True)
class Line:
    """A field: `type` is a base type or `package/Type`, `text` what ROS 1 sums for a base type.

    `length` is None for one value, the number of elements of an array, or the most that a list may have, 0 for any.
    """

    name: str
    type: str
    text: str
    length: int | None = None
    fixed: bool = False
    most_characters: int = 0

    @property
    def kind(self) -> Any:
        """The type as `rosbags` writes it."""
        inner: Any = (
            (Nodetype.NAME, self.type.replace("/", "/msg/"))
            if "/" in self.type
            else (Nodetype.BASE, (self.type, self.most_characters))
        )
        if self.length is None:
            return inner
        return (Nodetype.ARRAY if self.fixed else Nodetype.SEQUENCE, (inner, self.length))


@dataclass(frozen=True, slots=True)
class Definition:
    """A message type: its constants, a text each as ROS 1 sums them, and its fields."""

    name: str
    constants: tuple[str, ...]
    fields: tuple[Line, ...]

    @property
    def text(self) -> str:
        """The definition without comments."""
        return "".join(f"{line}\n" for line in (*self.constants, *(field.text for field in self.fields)))


def is_type(name: str) -> bool:
    """Tell whether a text can be the name of a type: `package/Type`."""
    return _TYPE.fullmatch(name) is not None


def split(name: str, text: str) -> Iterator[tuple[str, str]]:
    """Yield the names and texts of the definitions in what a publisher tells; ValueError for what is no such text."""
    if len(text) > _MOST_CHARACTERS:
        raise ValueError(f"it has {len(text)} characters, more than {_MOST_CHARACTERS}")
    first, *others = _SEPARATOR.split(text)
    yield name, first
    for other in others:
        heading, _, body = other.strip("\r\n").partition("\n")
        told = heading.removeprefix("MSG:").strip()
        if not heading.startswith("MSG:") or not is_type(told):
            raise ValueError(f"`{heading[:60]}` is not a heading of a definition")
        yield told, body


def read(name: str, text: str) -> Definition:
    """Return the definition that the lines of one message are; ValueError with the line that is none."""
    constants: list[str] = []
    fields: list[Line] = []
    for raw in text.splitlines():
        line = raw.strip()
        if constant := _CONSTANT.fullmatch(line):
            constants.append(_constant(constant))
        elif line := line.partition("#")[0].strip():
            fields.append(_field(name, line))
    names = [field.name for field in fields]
    if len(set(names)) < len(names):
        raise ValueError("two fields have the same name")
    return Definition(name, tuple(constants), tuple(fields))


def _constant(found: re.Match[str]) -> str:
    kind, name, value = found.groups()
    if kind not in _BASE:
        raise ValueError(f"a constant cannot be a `{kind}`")
    return f"{kind} {name}={(value if kind == 'string' else value.partition('#')[0]).strip()}"


def _field(owner: str, line: str) -> Line:
    found = _FIELD.fullmatch(line)
    if found is None:
        raise ValueError(f"`{line[:60]}` is not a field")
    kind, characters, bound, length, name = found.groups()
    if characters and kind != "string":
        raise ValueError(f"`{line[:60]}` is not a field")
    if length and int(length) > _MOST_ELEMENTS:
        raise ValueError(f"`{line[:60]}` has more elements than {_MOST_ELEMENTS}")
    shown = f"{kind}{f'<={characters}' if characters else ''}"
    shown += f"[{bound or ''}{length}]" if length is not None else ""
    return Line(
        name,
        _full(owner, kind),
        f"{shown} {name}",
        None if length is None else int(length or 0),
        bool(length) and not bound,
        int(characters or 0),
    )


def _full(owner: str, kind: str) -> str:
    if kind == "Header":
        return "std_msgs/Header"
    if kind in _TIMES or kind in _BASE:
        return _TIMES.get(kind, kind)
    return kind if "/" in kind else f"{owner.partition('/')[0]}/{kind}"


def sum_text(definition: Definition, sum_of: Callable[[str], str]) -> str:
    """Return the text whose MD5 sum peers of ROS 1 compare: constants first, sums in the place of message types.

    The rule is that of wiki.ros.org/ROS/Technical%20Overview, "Message serialization and msg MD5 sums".
    """
    shown = (
        field.text if "/" not in field.type or field.type in _TIMES.values() else f"{sum_of(field.type)} {field.name}"
        for field in definition.fields
    )
    return "\n".join((*definition.constants, *shown))
