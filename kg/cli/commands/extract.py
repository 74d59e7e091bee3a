"""`kg extract check`: errors in descriptions of framework calls."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from kg.cli.diagnostics import colored, render, say
from kg.cli.options import Json, argument, session, takes
from kg.cli.output import json_lines, write
from kg.errors import Exit, KgError
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import DECLARED

with lazily():
    from kg.pipeline.calls import call_files, read_calls
    from kg.symbolic.checking import check as find

Files = Annotated[list[str] | None, argument("FILE", "Files of descriptions; by default those of the setting `calls`.")]


@takes([DECLARED["calls"]])
def check(context: typer.Context, files: Files = None, *, json: Json = False, **given: str | None) -> None:
    """Check descriptions of framework calls: columns, types, arguments, matches.

    Descriptions define the calls of a framework whose sources `kg build` does not have (docs/calls.md). Reports rows
    that never match. Exits with 1 if there are errors. For example:

        kg extract check
        kg extract check calls/acme.toml
    """
    named = [Path(file) for file in files] if files else call_files(session(context).settings(**given))
    errors = find(read_calls(named))
    if json:
        json_lines(map(_object, errors))
    else:
        for error in errors:
            write(render(error, color=colored(sys.stdout)))
            write()
    say(f"{count(len(named), 'file')} checked: {count(len(errors), 'error') if errors else 'nothing wrong'}")
    if errors:
        raise typer.Exit(Exit.FOUND)


def _object(error: "KgError") -> dict[str, object]:
    place = error.place
    return {
        "code": error.code,
        "message": error.message,
        "file": place.path if place else None,
        "line": place.line if place else None,
        "column": place.column if place else None,
        "hint": error.hint,
    }
