"""Writes the pages that are made from the code, and what commands print in the others: `python docs/generate.py`.

tests/test_docs.py compares the result with what is kept.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Final

from transcripts import refreshed

from kg.cli.reference import markdown as commands_page
from kg.errors import CATALOGUE, Exit
from kg.query import stored
from kg.settings import DECLARED

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["PAGES", "SESSIONS", "main", "session"]

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


_SETTINGS: Final = """\
# Settings

<!-- Written by docs/generate.py from kg/settings.py. -->

A flag wins over the environment variable, that over the nearest `kg.toml` in the working folder or above it, that over
the default. `kg config show` tells the values in force and where each comes from. Relative paths in a file are relative
to it.

    # kg.toml
    store = "/data/kg"
    jobs = 8

| key of kg.toml | flag | variable | default | meaning |
|---|---|---|---|---|
"""


def settings_page() -> str:
    """Return docs/settings.md: every setting with its three names and its sentence."""
    rows = [
        f"| `{one.name}` | `{one.flag} {one.metavar}` | `{one.variable}` | {_default(one.default)} | {one.sentence} |\n"
        for one in DECLARED.values()
    ]
    return _SETTINGS + "".join(rows)


def _default(value: object) -> str:
    return "" if value in (None, ()) else f"`{value}`"


_QUERIES: Final = """\
# Stored queries

<!-- Written by docs/generate.py from queries/. -->

Questions that are already written. `kg query NAME` runs one, `kg query --list` lists them; the last part of a name is
enough where no other query has it. Parameters may be left out unless a query says so:

    kg query who-publishes --param topic=/cmd_vel

Folders of your own are added with the [setting](settings.md) `queries`: a file is SPARQL that runs as it stands, under
a header of comments like those in [queries/](../queries).
"""


def queries_page() -> str:
    """Return docs/queries.md: every query that is shipped, by family, with its description and parameters."""
    parts, family = [_QUERIES], ""
    for name, query in sorted(stored.discover(()).items()):
        first = name.split("/")[0]
        if first != family:
            family = first
            parts.append(f"\n## {family}\n")
        parts.append(f"\n### `{name}`\n\n{query.title}.".replace("?.", "?") + f" {query.description}".rstrip() + "\n")
        if query.parameters:
            parts.append("\n| parameter | for example | is |\n|---|---|---|\n")
        parts += [f"| `{one.name}` | `{one.example}` | {one.description} |\n" for one in query.parameters]
    return "".join(parts)


PAGES: Final[dict[str, Callable[[], str]]] = {
    "cli.md": commands_page,
    "errors.md": errors_page,
    "queries.md": queries_page,
    "settings.md": settings_page,
}
"""The pages that are made from the code, and what makes them."""

SESSIONS: Final = ("../README.md", "quickstart.md")
"""The pages with sessions, whose commands are run."""


def main() -> None:
    """Write every page, and say which changed."""
    for name, make in PAGES.items():
        _write(_FOLDER / name, make())
    for name in SESSIONS:
        path = (_FOLDER / name).resolve()
        with tempfile.TemporaryDirectory() as folder:
            _write(path, session(path, Path(folder)))


def session(page: Path, folder: Path) -> str:
    """Return a page with what its commands print now; they run in `folder`, which gets a copy of `examples/`."""
    shutil.copytree(_FOLDER.parent / "examples", folder / "examples")
    return refreshed(page.read_text(encoding="utf-8"), folder)


def _write(path: Path, text: str) -> None:
    if not path.is_file() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")
        sys.stderr.write(f"wrote {path.name}\n")


if __name__ == "__main__":
    main()
