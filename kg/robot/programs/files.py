"""Programs in files: text (`.kgp`), or JSON (`.json`) with its schema (docs/program.schema.json)."""

from __future__ import annotations

from inspect import cleandoc
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import msgspec

from kg.errors import Place, RobotError, UsageError
from kg.robot.programs.events import place_at
from kg.robot.programs.parse import parse_with_places
from kg.robot.programs.tree import BLOCKS_DEEP, EXPRESSIONS_DEEP, Program, expressions_of, height, statements
from kg.robot.programs.trees import program_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.robot.capability import Capabilities

_ID: Final = "https://w3id.org/rnkg/program.schema.json"


def encode(program: Program) -> bytes:
    """Return a program as indented JSON; defaults are omitted, except for the version."""
    content = {"version": program.version, **msgspec.to_builtins(program)}
    return msgspec.json.format(msgspec.json.encode(content), indent=2) + b"\n"


def decode(data: bytes | str, path: str = "program") -> Program:
    """Return the program in JSON; RobotError KG831 with the path that violates the schema."""
    try:
        program = msgspec.json.decode(data, type=Program)
        too_deep = any(
            sum(part.isdecimal() for part in where.split("/")) > BLOCKS_DEEP
            or any(height(one) > EXPRESSIONS_DEEP for _, one in expressions_of(statement))
            for where, statement in statements(program.body)
        )
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        message = "the program is nested too deeply" if isinstance(error, RecursionError) else str(error)
        raise RobotError("KG831", message, place=Place(path)) from None
    if too_deep:
        message = f"blocks are nested more than {BLOCKS_DEEP} deep, or expressions more than {EXPRESSIONS_DEEP}"
        raise RobotError("KG831", message, place=Place(path))
    return program


def schema() -> dict[str, Any]:
    """Return the JSON Schema of programs."""
    content = msgspec.json.decode(msgspec.json.encode(msgspec.json.schema(Program)))
    for kind in content["$defs"].values():
        if "description" in kind:
            kind["description"] = cleandoc(kind["description"])  # msgspec before 0.23 leaves it indented
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": _ID, "title": "A program for a robot"}
    return {**head, **content}


SUFFIX: Final = ".kgp"
"""File name suffix of programs in text."""
_MOST: Final = 4 << 20


class Loaded(NamedTuple):
    """A program with its file; `text` is None for JSON."""

    program: Program
    path: str
    text: str | None
    places: Mapping[str, tuple[int, int]]

    def place(self, path: str) -> Place:
        """Return the place in the file of a part of the tree."""
        return place_at(self.path, self.text, self.places, path)


def load(path: str) -> Loaded:
    """Read a program.

    Raises:
        UsageError: KG003 unreadable file.
        RobotError: KG830, KG831 invalid program.
    """
    data = _content(path)
    if path.endswith(".xml"):
        hint = f"Convert it: `kg robot convert {path} > {Path(path).stem}{SUFFIX}`."
        raise RobotError("KG830", "a behaviour tree is not a program", place=Place(path), hint=hint)
    if path.endswith(".json"):
        return Loaded(decode(data, path), path, None, {})
    try:
        text = data.decode()
    except UnicodeDecodeError:
        raise RobotError("KG830", "the text is not in UTF-8", place=Place(path)) from None
    program, places = parse_with_places(text, path)
    return Loaded(program, path, text.replace("\r\n", "\n"), places)


def load_tree(path: str, capabilities: Capabilities) -> Loaded:
    """Read a behaviour tree as a program.

    Raises:
        UsageError: KG003 unreadable file.
        RobotError: KG830 too large, KG842 no equivalent program.
    """
    return Loaded(program_of(_content(path), capabilities, path), path, None, {})


def _content(path: str) -> bytes:
    try:
        with Path(path).open("rb") as file:
            data = file.read(_MOST + 1)
    except OSError as error:
        raise UsageError("KG003", f"`{path}` cannot be read: {error.strerror}") from error
    if len(data) > _MOST:
        raise RobotError("KG830", "a program is not larger than 4 MB", place=Place(path))
    return data
