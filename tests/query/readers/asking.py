"""Helpers for tests of readers: send requests, and list processes."""

from __future__ import annotations

import asyncio
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from patience import patient

from kg.errors import KgError
from kg.query.readers.messages import Question

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.query.readers.messages import End, Head
    from kg.query.readers.pool import Readers

HERE: Final = Path(__file__).parent
FORMATS: Final = {"rows": "json", "boolean": "json", "graph": "ntriples"}
ALL: Final = "SELECT * { ?s ?p ?o }"
ENDLESS: Final = "SELECT (COUNT(*) AS ?n) {" + " ".join(f"?a{i} ?b{i} ?c{i} ." for i in range(14)) + "}"
STREAM: Final = "SELECT * {" + " ".join(f"?a{i} ?b{i} ?c{i} ." for i in range(14)) + "}"
"""Query with endless rows."""


def program(name: str) -> tuple[str, ...]:
    """Return the command of a fork server modified by a file in this folder."""
    return (sys.executable, "-P", str(HERE / "cases" / name))


def question(text: str, formats: dict[str, str] = FORMATS, **options: Any) -> Question:
    """Return a question for JSON, or for the given formats."""
    return Question(text=text, formats=formats, **options)


async def whole(
    readers: Readers, text: str, *, seconds: float | None = None, job: str | None = None, **options: Any
) -> tuple[Head, bytes, End]:
    """Return the head, the body and the end of a response; without `seconds` there is no deadline."""
    async with readers.ask(question(text, **options), seconds=seconds or patient(20), job=job) as answer:
        body = b"".join([part async for part in answer.parts()])
        assert answer.end is not None
        return answer.head, body, answer.end


async def outcome(readers: Readers, text: str, **options: Any) -> str:
    """Return the code of the error that a question results in, or `whole`."""
    try:
        await whole(readers, text, **options)
    except KgError as error:
        return error.code
    return "whole"


async def until(condition: Callable[[], object], seconds: float = 20) -> None:
    """Wait until a condition holds, with time for a busy machine."""
    async with asyncio.timeout(patient(seconds)):
        while not condition():  # noqa: ASYNC110 - no event tells of what the system does
            await asyncio.sleep(0.01)


def descendants(pid: int | None = None) -> dict[int, int]:
    """Return the descendants of a process, by default this one, with their processor time in ticks (Linux)."""
    parents: dict[int, tuple[int, int]] = {}
    for folder in Path("/proc").iterdir():
        if folder.name.isdigit():
            try:
                fields = (folder / "stat").read_text().rpartition(")")[2].split()
            except OSError:
                continue
            if fields[0] != "Z":
                parents[int(folder.name)] = (int(fields[1]), int(fields[11]) + int(fields[12]))
    found: dict[int, int] = {}
    wanted = {pid or os.getpid()}
    while wanted:
        below = {child: ticks for child, (parent, ticks) in parents.items() if parent in wanted and child not in found}
        found |= below
        wanted = set(below)
    return found
