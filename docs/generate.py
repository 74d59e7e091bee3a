"""Writes the pages that are made from the code: `python docs/generate.py`; tests/test_docs.py compares them."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.errors import CATALOGUE, Exit

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["PAGES", "main"]

_FOLDER: Final = Path(__file__).resolve().parent

_ROOMS: Final = {
    "0": "Usage and settings",
    "1": "Reading sources",
    "2": "Rules",
    "3": "The store",
    "4": "Findings in an architecture",
    "5": "Queries",
    "6": "Graph and ontology",
    "7": "Robots",
    "9": "Inside kg",
}

_EXITS: Final = {
    Exit.OK: "it worked",
    Exit.FOUND: "it worked and there is something to report, or what was asked for was not found",
    Exit.USAGE: "the command, an option or a setting is wrong",
    Exit.SOURCE: "a source could not be read at all",
    Exit.STORE: "the store is missing, busy, damaged or full",
    Exit.QUERY: "a query was refused or failed",
    Exit.TIMEOUT: "a deadline or a limit ended the work",
    Exit.INTERNAL: "a defect in `kg`",
    Exit.INTERRUPTED: "Ctrl-C",
}

_INTRODUCTION: Final = """\
# Error codes

<!-- Written by docs/generate.py from kg/errors.py. -->

Every error carries a code, the place it is about and the way out. `kg explain CODE` prints the entries below.
What is wrong in sources does not stop a build: it is reported by name, and the rest is built.

## Exit codes

| code | when |
|---|---|
"""


def errors_page() -> str:
    """Return docs/errors.md: the exit codes, then every code of the catalogue under its room."""
    parts = [_INTRODUCTION + "".join(f"| {int(code)} | {when} |\n" for code, when in _EXITS.items())]
    room = None
    for code, entry in sorted(CATALOGUE.items()):
        if code[2] != room:
            room = code[2]
            parts.append(f"\n## {_ROOMS[room]}\n")
        parts.append(f"\n### {code}: {entry.title}\n\n{entry.explanation}\n\nWay out: {entry.way_out}\n")
    return "".join(parts)


PAGES: Final[dict[str, Callable[[], str]]] = {"errors.md": errors_page}
"""The pages that are made from the code, and what makes them."""


def main() -> None:
    """Write every page, and say which changed."""
    for name, make in PAGES.items():
        path, text = _FOLDER / name, make()
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
            sys.stderr.write(f"wrote {path.name}\n")


if __name__ == "__main__":
    main()
