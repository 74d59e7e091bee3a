"""`kg robot params`: reading and setting parameters, and their output."""

from __future__ import annotations

import asyncio
import math
from typing import TYPE_CHECKING, Any, Final

import msgspec

from kg.cli.diagnostics import note, problem
from kg.cli.output import Column, json_line, listing, terminal, write
from kg.render.text import json_text, printable
from kg.robot.connecting import address_of, connected, inhabited, is_recording, not_commanded
from kg.robot.parameters import NodeParameter, find, parsed, read
from kg.robot.parameters import write as write_parameter

if TYPE_CHECKING:
    from kg.robot.connection import GraphProblem
    from kg.settings import Settings

_COLUMNS: Final = (
    Column("node", spare=1),
    Column("parameter", "name"),
    Column("type"),
    Column("value"),
    Column("limits", spare=2),
    Column("description", "dim", spare=3),
)
_LONGEST: Final = 60


def show_parameters(settings: Settings, node: str | None, name: str | None, *, json: bool) -> None:
    """Write the parameters of a robot or node, or one parameter; raises as `kg.robot.parameters.read`."""
    found, problems = asyncio.run(_read(address_of(settings), node, name))
    for one in problems:
        problem(one.code, one.message, one.subject)
    listing(_COLUMNS, map(_row, found), objects=map(_object, found) if json else None)


async def _read(address: str, node: str | None, name: str | None) -> tuple[list[NodeParameter], list[GraphProblem]]:
    async with connected(address) as connection:
        await inhabited(connection)
        if node is None or name is None:
            return await read(connection, node)
        return [await find(connection, node, name)], []


def set_parameter(  # noqa: PLR0913 - the arguments and options of the command
    settings: Settings, node: str, name: str, text: str, *, dry_run: bool, json: bool
) -> None:
    """Set a parameter and write its old and new value; raises as `parsed` and `write` of `kg.robot.parameters`."""
    address = address_of(settings)
    if is_recording(address):
        raise not_commanded(address)
    before, after = asyncio.run(_set(address, node, name, text, dry_run=dry_run))
    if json or not terminal():
        write(json_line({**_object(after), "before": _plain(before.value), "set": not dry_run}).rstrip("\n"))
    else:
        done = "would be" if dry_run else "is"
        note(f"{after.name} of {after.node} was {_shown(before)}, and {done} {_shown(after)}")


async def _set(address: str, node: str, name: str, text: str, *, dry_run: bool) -> tuple[NodeParameter, NodeParameter]:
    async with connected(address) as connection:
        await inhabited(connection)
        before = await find(connection, node, name, new=True)
        value = parsed(before, text)
        if dry_run:
            return before, msgspec.structs.replace(before, value=value)
        return before, await write_parameter(connection, before, value)


def _object(one: NodeParameter) -> dict[str, Any]:
    told: dict[str, Any] = msgspec.to_builtins(one)
    return {**told, "value": _plain(one.value)}


def _plain(value: Any) -> Any:
    """Return a value for JSON; numbers that are not finite are written as in YAML."""
    if isinstance(value, list):
        return [_plain(one) for one in value]
    if isinstance(value, float) and not math.isfinite(value):
        return ".nan" if math.isnan(value) else ".inf" if value > 0 else "-.inf"
    return value


def _shown(one: NodeParameter) -> str:
    if one.value is None:
        return "not set"
    value = _plain(one.value)
    text = printable(value) if isinstance(value, str) else json_text(value)
    return text if len(text) <= _LONGEST or not terminal() else f"{text[: _LONGEST - 3]}..."


def _row(one: NodeParameter) -> tuple[str, ...]:
    bounds = [f"{bound:g}" if bound is not None else "" for bound in (one.minimum, one.maximum)]
    limits = " to ".join(bounds) if any(bounds) else one.constraints
    if one.read_only:
        limits = ", ".join(filter(None, ("read-only", limits)))
    return one.node, one.name, one.type, _shown(one), limits, one.description
