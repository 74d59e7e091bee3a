"""Interface definitions in OMG IDL (`.idl` files of ROS 2), and how parsed types and values are written as facts.

The grammar is that of `rosbags`, which knows the part of IDL 4.2 that `rosidl` generates. It tells no lines: a field
stands on the first line, from the one before it on, that holds its name as a word.
"""

from __future__ import annotations

import re
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Final

from kg.facts import Field, InterfaceDefinition, Location

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosbags.typesys.base import Message, Type

    from kg.corpus.reading import Reader

__all__ = ["read_idl", "type_name", "value_text"]

_SUFFIXES: Final = {
    "msg": {"": "message"},
    "srv": {"_Request": "request", "_Response": "response"},
    "action": {"_Goal": "goal", "_Result": "result", "_Feedback": "feedback"},
}


def read_idl(reader: Reader, package: str, path: str) -> tuple[InterfaceDefinition, ...]:
    """Return the definition in the `.idl` file at `path` of a folder msg, srv or action, as a tuple of none or one.

    What the grammar does not know becomes a problem KG118 of the `reader`.
    """
    place = PurePosixPath(path)
    content = reader.read(path) if place.parent.name in _SUFFIXES else None
    if content is None:
        return ()
    text = content.decode()
    try:
        messages = _parse(text)
    except ValueError as error:
        reader.problem("KG118", f"no IDL that is known: {error}", path, 1)
        return ()
    fields = tuple(_fields(messages, place, text.splitlines()))
    return (InterfaceDefinition(place.parent.name, package, place.stem, fields, Location(path, 1)),)


def _parse(text: str) -> list[Message]:
    """Raise `ValueError` where the grammar of rosbags does not know the text."""
    from rosbags.typesys import TypesysError  # noqa: PLC0415 - hardly any package has IDL files
    from rosbags.typesys.idl import IDLParser  # noqa: PLC0415 - the same

    directives_blanked = "\n".join("" if line.lstrip().startswith("#") else line for line in text.splitlines())
    try:
        return IDLParser(directives_blanked).specification()
    except (TypesysError, RecursionError, LookupError, AttributeError, AssertionError) as error:
        raise ValueError(str(error).rpartition("\n")[2] or type(error).__name__) from error


def _fields(messages: list[Message], place: PurePosixPath, lines: list[str]) -> Iterator[Field]:
    sections = {place.stem + suffix: name for suffix, name in _SUFFIXES[place.parent.name].items()}
    for message in messages:
        struct = PurePosixPath(message.name).name
        if struct not in sections:
            continue
        start = _line_of(f"{struct}_Constants", lines, 1)
        for constant in message.constants:
            start = _line_of(constant.name, lines, start)
            value = value_text(constant.value)
            yield Field(sections[struct], constant.name, constant.typ.value, start, constant=value)
        start = _line_of(struct, lines, 1)
        for field in message.fields:
            start = _line_of(field.name, lines, start)
            yield Field(sections[struct], field.name, type_name(field.typ), start)


def _line_of(word: str, lines: list[str], start: int) -> int:
    """Return the number of the first line from `start` on that holds `word`; `start` itself where none does."""
    pattern = re.compile(rf"\b{re.escape(word)}\b")
    return next((number for number in range(start, len(lines) + 1) if pattern.search(lines[number - 1])), start)


def type_name(kind: Type) -> str:
    """Return a type as facts write it: `std_msgs/Header`, `string<=10`, `uint8[4]`, `uint8[]`, `uint8[<=4]`."""
    base = kind.ref.name.replace("/msg/", "/") if isinstance(kind.ref.name, str) else kind.ref.name.value
    bound = f"<={kind.str_size}" if kind.str_size else ""
    return f"{base}{bound}{_brackets(kind)}"


def _brackets(kind: Type) -> str:
    if kind.cardinality.value == "scalar":
        return ""
    if kind.cardinality.value == "array":
        return f"[{kind.size}]"
    return f"[<={kind.size}]" if kind.size else "[]"


def value_text(value: object) -> str:
    """Return a value as a definition writes it; strings stand without their quotes."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list):
        return f"[{', '.join(value_text(item) for item in value)}]"
    return str(value)
