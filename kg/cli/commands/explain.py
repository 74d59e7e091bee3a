"""`kg explain`: what an error code means."""

from typing import Annotated

import typer

from kg.cli.completion import codes
from kg.cli.options import Json
from kg.cli.output import json_lines, write
from kg.errors import CATALOGUE
from kg.similar import unknown

Code = Annotated[
    str | None,
    typer.Argument(metavar="CODE", help="Code such as KG101; by default all are listed.", autocompletion=codes),
]


def explain(code: Code = None, *, json: Json = False) -> None:
    """Explain an error code and how to fix the error.

    Without a code, lists all codes. For example:

        kg explain KG301
    """
    chosen = {code.upper(): CATALOGUE[code.upper()]} if code and code.upper() in CATALOGUE else CATALOGUE
    if code and len(chosen) != 1:
        raise unknown("code", code, CATALOGUE, otherwise="`kg explain` lists the codes.")
    if json:
        json_lines(
            {"code": key, "title": one.title, "explanation": one.explanation, "way_out": one.way_out}
            for key, one in chosen.items()
        )
    elif code:
        for key, one in chosen.items():
            write(f"{key}: {one.title}\n\n{one.explanation}\n\nFix: {one.way_out}")
    else:
        for key, one in chosen.items():
            write(f"{key}  {one.title}")
