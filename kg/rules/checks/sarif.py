"""Findings about rules as plain values, and as remarks at their lines for SARIF and GitHub."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from kg.render.sarif import Remark, Spot, document

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.rules.checks.finding import Finding


def as_object(finding: Finding) -> dict[str, object]:
    """Return a finding as plain values: the keys of `Finding`, its place as `file`, `line` and `column`."""
    return {
        "code": finding.code,
        "severity": finding.severity,
        "rule": finding.rule,
        "message": finding.message,
        "file": finding.place.path,
        "line": finding.place.line,
        "column": finding.place.column,
        "hint": finding.hint,
    }


def sarif(findings: Sequence[Finding], root: Path) -> dict[str, object]:
    """Return findings as one run; files below `root` are named relative to it."""
    remarks = []
    for finding in findings:
        path, place = Path(finding.place.path).absolute(), finding.place
        uri = path.relative_to(root).as_posix() if path.is_relative_to(root) else path.as_uri()
        text = f"{finding.message}. {finding.hint}" if finding.hint else finding.message
        remarks.append(Remark(finding.code, finding.severity, text, Spot(uri, place.line, place.column)))
    return document(remarks)


def remark(finding: Finding) -> Remark:
    """Return a finding as a remark at its line, the file as it was named."""
    place = finding.place
    return Remark(finding.code, finding.severity, finding.message, Spot(place.path, place.line, place.column))
