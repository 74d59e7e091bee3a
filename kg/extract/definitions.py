"""Interface definitions of a package: its `.msg`, `.srv`, `.action` and `.idl` files, field by field.

A definition in the `.msg` notation is a list of lines that do not depend on each other, so that a bad line hides
nothing of its file. IDL is read by the grammar of `rosbags`. Sources: wiki.ros.org/msg, wiki.ros.org/srv,
wiki.ros.org/actionlib and docs.ros.org "About ROS 2 interfaces".
"""

from __future__ import annotations

import re
from contextlib import suppress
from functools import partial
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Final

from kg.facts import Field, FileKind, InterfaceDefinition, Location
from kg.lazily import lazily

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosbags.typesys.base import Message, Type

    from kg.corpus.reading import Reader
    from kg.corpus.workspace import PackageFolder

with lazily():
    from rosbags.typesys.idl import IDLParser

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
        reader.problem("KG118", f"not valid IDL: {error}", path, 1)
        return ()
    fields = tuple(_idl_fields(messages, place, text.splitlines()))
    return (InterfaceDefinition(place.parent.name, package, place.stem, fields, Location(path, 1)),)


def _parse(text: str) -> list[Message]:
    """Raise `ValueError` where the grammar of rosbags does not know the text."""
    from rosbags.typesys import TypesysError  # noqa: PLC0415 - hardly any package has IDL files

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
_PRIMITIVE: Final = frozenset(
    {
        "bool", "byte", "char", "float32", "float64", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64",
        "uint64", "string", "wstring", "time", "duration",
    }
)  # fmt: skip
_LINE: Final = re.compile(
    r"(?:(?P<package>[A-Za-z]\w*)/(?:msg/)?)?(?P<type>[A-Za-z]\w*)(?P<bounds>(?:<=\d+)?(?:\[(?:<=)?\d*\])?)"
    r"\s+(?P<name>[A-Za-z]\w*)(?:\s*=\s*(?P<constant>.*)|\s+(?P<default>.+))?"
)
"""A field or constant: the type with its bounds, the name, and what is behind it, without comment."""
_CODE: Final = re.compile(r"""(?:[^#"']|"[^"]*"?|'[^']*'?)*""")
"""What is before the first `#` outside of quotes."""
_QUOTED: Final = re.compile(r"""(["'])(.*?)\1\s*(?:#\s*(.*))?""")
"""A text in quotes and a comment behind it."""


def read_definitions(reader: Reader, package: PackageFolder) -> tuple[InterfaceDefinition, ...]:
    """Return the interface definitions of `package`; what does not parse becomes a problem KG118 of the `reader`."""
    found: list[InterfaceDefinition] = []
    for entry in package.files:
        if entry.path.endswith(".idl"):
            found.extend(read_idl(reader, package.name, entry.path))
        elif entry.kind in _SECTIONS and (content := reader.read(entry.path)) is not None:
            fields = _fields(reader, package.name, entry.kind, entry.path, content.decode())
            name = PurePosixPath(entry.path).stem
            found.append(InterfaceDefinition(entry.kind.value, package.name, name, fields, Location(entry.path, 1)))
    return tuple(found)


def fields_of(text: str, package: str) -> list[Field]:
    """Return the fields and constants of a message in the `.msg` notation, without lines that follow no grammar."""
    lines = enumerate((line.strip() for line in text.splitlines()), start=1)
    read = (_field(line, "message", package, number) for number, line in lines if line and not line.startswith("#"))
    return [field for field in read if field is not None]


def _fields(reader: Reader, package: str, kind: FileKind, path: str, text: str) -> tuple[Field, ...]:
    sections = _SECTIONS[kind]
    section, fields = 0, []
    for number, line in enumerate(text.splitlines(), start=1):
        written = line.strip()
        if written.startswith(_SEPARATOR):
            section += 1
            if section == len(sections):
                reader.problem("KG118", f"a {kind.value} has {len(sections)} sections, not more", path, number)
                break
        elif written and not written.startswith("#"):
            field = _field(written, sections[section], package, number)
            if field is None:
                reader.problem("KG118", f"no field or constant: {written[:80]}", path, number)
            else:
                fields.append(field)
    return tuple(fields)


def _field(written: str, section: str, package: str, line: int) -> Field | None:
    """Return what a line (stripped, not empty, no comment) declares, or None if it follows no grammar."""
    code = written[: _CODE.match(written).end()].rstrip()  # type: ignore[union-attr]  # it matches every text
    match = _LINE.fullmatch(code)
    if match is None:
        return None
    home, kind, constant, default = match["package"], match["type"], match["constant"], match["default"]
    comment: str | None = written[len(code) :].strip().lstrip("#").strip() or None
    is_text = home is None and kind in ("string", "wstring")
    if home is None and kind not in _PRIMITIVE:
        home = "std_msgs" if kind == "Header" else package
    if constant is not None and is_text:
        whole = written[match.start("constant") :].strip()
        quoted = _QUOTED.fullmatch(whole)
        # In ROS 1 a constant is all of the line, with quotes and comments; ROS 2 has texts in quotes.
        constant, comment = (quoted[2], quoted[3] or None) if quoted else (_unquoted(whole), None)
    elif constant is not None:
        constant = _literal(constant) or constant
    elif default is not None and is_text and "[" not in match["bounds"]:
        default = _unquoted(default)
    elif default is not None and (default := _literal(default)) is None:
        return None
    full = f"{home}/{kind}" if home is not None else kind
    return Field(section, match["name"], f"{full}{match['bounds']}", line, default, constant, comment)


def _unquoted(text: str) -> str:
    return text[1:-1] if len(text) > 1 and text[0] in "\"'" and text.find(text[0], 1) == len(text) - 1 else text


def _literal(text: str) -> str | None:
    """Return a number, a truth value or a list as facts have it; None for anything else."""
    if text.startswith("[") and text.endswith("]"):
        items = [_literal(item.strip()) or item.strip() for item in text[1:-1].split(",") if item.strip()]
        return f"[{', '.join(items)}]"
    for read in (int, partial(int, base=0), float):
        with suppress(ValueError):
            return str(read(text))
    return text.lower() if text.lower() in ("true", "false") else None
