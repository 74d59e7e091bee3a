"""Findings of checks in the formats of `--format`: text, JSON Lines, SARIF, and annotations of GitHub."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Annotated, Final

from kg.cli.options import option, require_one_of
from kg.cli.output import json_lines, write
from kg.codes import SEVERITIES
from kg.lazily import lazily
from kg.render.text import count

if TYPE_CHECKING:
    from kg.render.sarif import Remark

with lazily():
    from kg.render.sarif import annotation, document

_FORMATS: Final = ("text", "json", "sarif", "github")

Form = Annotated[str, option("--format -f FORMAT", f"One of {', '.join(_FORMATS)}.")]
Level = Annotated[str, option("--level SEVERITY", "Lowest severity to show: error, warning or note.")]


def require_valid(form: str, level: str = SEVERITIES[-1], hints: Mapping[str, str] | None = None) -> None:
    """Raise UsageError KG003 for an unknown format or severity; `hints` maps some words to a hint."""
    require_one_of(form, _FORMATS, "format", (hints or {}).get(form, ""))
    require_one_of(level, SEVERITIES, "severity")


def write_remarks(form: str, *, lines: Iterable[str], objects: Iterable[object], remarks: Iterable[Remark]) -> None:
    """Write findings in a format: as lines of text, as objects of JSON, or as remarks for SARIF and GitHub."""
    if form == "json":
        json_lines(objects)
    elif form == "sarif":
        json_lines([document(list(remarks))])
    else:
        for line in map(annotation, remarks) if form == "github" else lines:
            write(line)


def totals(severities: Iterable[str]) -> str:
    """Return how many findings there are of each severity, in words; empty without any."""
    sums = Counter(severities)
    return ", ".join(count(sums[severity], severity) for severity in SEVERITIES if sums[severity])
