"""Interface definitions of a package: its `.msg`, `.srv`, `.action` and `.idl` files, field by field.

Types, constants and defaults are read by the grammar of `rosbags`. A definition in the `.msg` notation is a list of
lines that do not depend on each other, so the grammar is asked for one line at a time and remembers the lines it has
seen: that gives every field its line, keeps a bad line from hiding the rest of its file, and reads the thousand
`std_msgs/Header header` of a workspace once. Sources: wiki.ros.org/msg, wiki.ros.org/srv, wiki.ros.org/actionlib and
docs.ros.org "About ROS 2 interfaces".
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Final

from kg.facts import Field, FileKind, InterfaceDefinition, Location

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from rosbags.typesys.base import Field as ParsedField
    from rosbags.typesys.base import Message, Type

    from kg.corpus.reading import Reader
    from kg.corpus.workspace import PackageFolder

__all__ = ["read_definitions"]

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
    fields = tuple(_idl_fields(messages, place, text.splitlines()))
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


def _idl_fields(messages: list[Message], place: PurePosixPath, lines: list[str]) -> Iterator[Field]:
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


_SECTIONS: Final = {
    FileKind.MESSAGE: ("message",),
    FileKind.SERVICE: ("request", "response"),
    FileKind.ACTION: ("goal", "result", "feedback"),
}
_SEPARATOR: Final = "---"
_OWN_PACKAGE: Final = "_"
"""Stands for the package of the definition in what the grammar returns, which is remembered across packages."""
_OLD_TIMES: Final = ("time", "duration")
_WIDE: Final = f"{_OWN_PACKAGE}/wstring"
_REMEMBERED_LINES: Final = 20_000


def read_definitions(reader: Reader, package: PackageFolder) -> tuple[InterfaceDefinition, ...]:
    """Return the interface definitions of `package`; what does not parse becomes a problem KG118 of the `reader`."""
    found: list[InterfaceDefinition] = []
    for entry in package.files:
        if entry.path.endswith(".idl"):
            found.extend(read_idl(reader, package.name, entry.path))
        elif entry.kind in _SECTIONS and (content := reader.read(entry.path)) is not None:
            fields = _fields(_File(reader, package.name, entry.kind, entry.path, content.decode()))
            name = PurePosixPath(entry.path).stem
            found.append(InterfaceDefinition(entry.kind.value, package.name, name, fields, Location(entry.path, 1)))
    return tuple(found)


@dataclass(frozen=True, slots=True)
class _File:
    reader: Reader
    package: str
    kind: FileKind
    path: str
    text: str

    def malformed(self, message: str, line: int | None) -> None:
        self.reader.problem("KG118", message, self.path, line)


@dataclass(frozen=True, slots=True)
class _Declaration:
    """What one line declares; `type` names the definition's own package `_`."""

    name: str
    type: str
    default: str | None = None
    constant: str | None = None
    comment: str | None = None


def _fields(file: _File) -> tuple[Field, ...]:
    sections = _SECTIONS[file.kind]
    section, fields = 0, []
    for number, line in enumerate(file.text.splitlines(), start=1):
        written = line.strip()
        if written.startswith(_SEPARATOR):
            section += 1
            if section == len(sections):
                file.malformed(f"a {file.kind.value} has {len(sections)} sections, not more", number)
                break
        elif written and not written.startswith("#"):
            declaration = _declaration(written)
            if declaration is None:
                file.malformed(f"no field or constant: {written[:80]}", number)
                continue
            fields.append(_field(declaration, sections[section], file.package, number))
    return tuple(fields)


def _field(declaration: _Declaration, section: str, package: str, line: int) -> Field:
    kind = declaration.type
    own = f"{_OWN_PACKAGE}/"
    return Field(
        section,
        declaration.name,
        package + kind.removeprefix(_OWN_PACKAGE) if kind.startswith(own) else kind,
        line,
        declaration.default,
        declaration.constant,
        declaration.comment,
    )


@lru_cache(maxsize=_REMEMBERED_LINES)
def _declaration(written: str) -> _Declaration | None:
    """Return what a line (stripped, not empty, no comment) declares, or None where it follows no grammar."""
    message = _grammar()(written)
    if message is None:
        return _bounded_wide_string(written) or _lenient_constant(written)
    for constant in message.constants:
        kind = constant.typ.value
        comment = None if kind == "string" else _comment(written)
        return _Declaration(constant.name, kind, constant=value_text(constant.value), comment=comment)
    for field in message.fields:
        if isinstance(field.value, str) and not _is_text(field):
            return _lenient_constant(written)
        default = None if field.value is None else value_text(field.value)
        return _Declaration(field.name, _type(field, written), default, comment=_comment(written))
    return None


def _is_text(field: ParsedField) -> bool:
    """Tell whether a string can be the default of a field; rosbags takes the rest of any line for one."""
    return type_name(field.typ).removeprefix(f"{_OWN_PACKAGE}/").startswith(("string", "wstring"))


def _bounded_wide_string(written: str) -> _Declaration | None:
    if not written.startswith("wstring<="):
        return None
    narrow = _declaration(written.removeprefix("w"))
    return narrow and replace(narrow, type=f"w{narrow.type}")


def _lenient_constant(written: str) -> _Declaration | None:
    """Read a constant as ROS 1 does: a name in any case, and the rest of the line as the value of a string."""
    left, equals, value = written.partition("=")
    message = _grammar()(left.strip()) if equals and "#" not in left else None
    if message is None or not message.fields or message.fields[0].value is not None:
        return None
    field = message.fields[0]
    kind = _type(field, written)
    if kind == "string":
        return _Declaration(field.name, kind, constant=value.strip())
    return _Declaration(field.name, kind, constant=value.partition("#")[0].strip(), comment=_comment(written))


@cache
def _grammar() -> Callable[[str], Message | None]:
    """Return a function from one line to the message that rosbags makes of it; rosbags is imported here, on demand."""
    from rosbags.typesys import TypesysError  # noqa: PLC0415 - a package without definitions need not pay for it
    from rosbags.typesys.msg import MSGParser  # noqa: PLC0415 - the same

    def read(line: str) -> Message | None:
        try:
            return MSGParser(f"MSG: {_OWN_PACKAGE}/msg/{_OWN_PACKAGE}\n{line}").specification()[0]
        except (TypesysError, RecursionError, ValueError):
            return None

    return read


def _type(field: ParsedField, written: str) -> str:
    """Return the type of a field; the times of ROS 1, which rosbags takes for messages, keep their names."""
    kind = type_name(field.typ)
    for old in _OLD_TIMES:
        if written.startswith(old) and not written.removeprefix(old)[0].isalnum():
            return kind.replace(f"builtin_interfaces/{old.capitalize()}", old)
    return kind.removeprefix(f"{_OWN_PACKAGE}/") if kind.startswith(_WIDE) else kind


def _comment(written: str) -> str | None:
    """Return the comment behind a declaration: what follows the first `#` outside of quotes."""
    quote = ""
    for position, character in enumerate(written):
        if quote:
            quote = "" if character == quote else quote
        elif character in "\"'":
            quote = character
        elif character == "#":
            return written[position:].lstrip("#").strip() or None
    return None
