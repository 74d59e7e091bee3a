"""What commands share that make remarks about lines: how these are written, and which are shown."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Final

import typer

from kg.cli.options import require_one_of
from kg.codes import SEVERITIES

_FORMATS: Final = ("text", "json", "sarif", "github")

Form = Annotated[str, typer.Option("--format", "-f", metavar="FORMAT", help=f"One of {', '.join(_FORMATS)}.")]
Level = Annotated[
    str, typer.Option("--level", metavar="SEVERITY", help="Lowest severity to show: error, warning or note.")
]


def require_valid(form: str, level: str = SEVERITIES[-1], hints: Mapping[str, str] | None = None) -> None:
    """Raise UsageError KG003 for an unknown format or severity; `hints` maps some words to a hint."""
    require_one_of(form, _FORMATS, "format", (hints or {}).get(form, ""))
    require_one_of(level, SEVERITIES, "severity")
