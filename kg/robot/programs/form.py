"""The JSON form of programs, and its schema (docs/program.schema.json)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import msgspec

from kg.errors import Place, RobotError
from kg.robot.programs.tree import Program
from kg.robot.programs.walk import BLOCKS_DEEP, EXPRESSIONS_DEEP, expressions_of, height, statements

if TYPE_CHECKING:
    from kg.robot.programs.tree import Statement

__all__ = ["decode", "encode", "schema"]

_ID: Final = "https://w3id.org/rnkg/program.schema.json"


def encode(program: Program) -> bytes:
    """Return a program as JSON, indented; what has its default is left out, but the version."""
    made = {"version": program.version, **msgspec.to_builtins(program)}
    return msgspec.json.format(msgspec.json.encode(made), indent=2) + b"\n"


def decode(data: bytes | str, path: str = "program") -> Program:
    """Return the program that JSON is; RobotError KG831 with the path where it follows the schema no more."""
    try:
        program = msgspec.json.decode(data, type=Program)
        too_deep = any(_too_deep(where, statement) for where, statement in statements(program.body))
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        message = "the program is nested too deeply" if isinstance(error, RecursionError) else str(error)
        raise RobotError("KG831", message, place=Place(path)) from None
    if too_deep:
        message = f"blocks are nested more than {BLOCKS_DEEP} deep, or expressions more than {EXPRESSIONS_DEEP}"
        raise RobotError("KG831", message, place=Place(path))
    return program


def _too_deep(path: str, statement: Statement) -> bool:
    blocks = sum(part.isdecimal() for part in path.split("/")) > BLOCKS_DEEP
    return blocks or any(height(one) > EXPRESSIONS_DEEP for _, one in expressions_of(statement))


def schema() -> dict[str, Any]:
    """Return the JSON Schema of the form."""
    made = msgspec.json.decode(msgspec.json.encode(msgspec.json.schema(Program)))
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": _ID, "title": "A program for a robot"}
    return {**head, **made}
