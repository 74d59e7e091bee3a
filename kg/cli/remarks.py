"""What commands share that make remarks about lines: how these are written, and which are shown."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Final

import typer

from kg.codes import SEVERITIES
from kg.errors import UsageError

_FORMATS: Final = ("text", "json", "sarif", "github")

Form = Annotated[str, typer.Option("--format", "-f", metavar="FORMAT", help=f"One of {', '.join(_FORMATS)}.")]
Level = Annotated[
    str, typer.Option("--level", metavar="SEVERITY", help="Lowest severity to show: error, warning or note.")
]


def require_known(form: str, level: str = SEVERITIES[-1], hints: Mapping[str, str] | None = None) -> None:
    """Raise UsageError KG003 for an unknown format or severity; `hints` maps some words to a hint."""
    for word, allowed, what in ((form, _FORMATS, "format"), (level, SEVERITIES, "severity")):
        if word not in allowed:
            hint = (hints or {}).get(word) or f"One of {', '.join(allowed)}."
            raise UsageError("KG003", f"unknown {what} `{word}`", hint=hint)
