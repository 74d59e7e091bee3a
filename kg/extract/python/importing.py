"""Reads which modules a file of Python imports, without parsing it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

_IMPORT: Final = re.compile(
    rb"^[ \t]*(?:from[ \t]+(\.*[\w.]*)[ \t]+import[ \t]+\(?([^#\n\\)]*)|import[ \t]+([\w., \t]+))"
    rb"|\b(?:import_module|uvicorn\.run)\([ \t]*[\"']([\w.]+)",
    re.MULTILINE,
)


def imported(source: bytes) -> Iterator[tuple[list[str], int]]:
    """Yield each imported module with its line, from 1; names that may be modules in it follow the module."""
    line, counted = 1, 0
    for match in _IMPORT.finditer(source):
        listed = match[3] or match[4]
        at = match.start(match.lastindex or 0) if listed is not None else match.start(1)
        line, counted = line + source.count(b"\n", counted, at), at
        if listed is not None:
            yield from (
                ([names[0]], line) for each in listed.decode("utf-8", "replace").split(",") if (names := each.split())
            )
            continue
        module = match[1].decode("utf-8", "replace")
        inside = [(each.split() or [""])[0] for each in match[2].decode("utf-8", "replace").split(",")]
        joint = "" if module.endswith(".") else "."
        yield [module, *(f"{module}{joint}{each}" for each in inside if each.isidentifier())], line
