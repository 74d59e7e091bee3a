"""Findings as SARIF 2.1.0 (OASIS), which code hosts show beside the lines."""

from __future__ import annotations

from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.codes import CATALOGUE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.rules.checks.finding import Finding

__all__ = ["as_object", "sarif"]

_SCHEMA: Final = "https://json.schemastore.org/sarif-2.1.0.json"


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
    codes = sorted({finding.code for finding in findings})
    driver = {
        "name": "kg",
        "version": version("kg-ros"),
        "rules": [
            {
                "id": code,
                "shortDescription": {"text": CATALOGUE[code].title},
                "fullDescription": {"text": CATALOGUE[code].explanation},
                "help": {"text": CATALOGUE[code].way_out},
            }
            for code in codes
        ],
    }
    results = [_result(finding, codes, root) for finding in findings]
    return {"$schema": _SCHEMA, "version": "2.1.0", "runs": [{"tool": {"driver": driver}, "results": results}]}


def _result(finding: Finding, codes: list[str], root: Path) -> dict[str, object]:
    path = Path(finding.place.path).absolute()
    uri = path.relative_to(root).as_posix() if path.is_relative_to(root) else path.as_uri()
    region = {"startLine": finding.place.line or 1}
    if finding.place.column:
        region["startColumn"] = finding.place.column
    text = f"{finding.message}. {finding.hint}" if finding.hint else finding.message
    return {
        "ruleId": finding.code,
        "ruleIndex": codes.index(finding.code),
        "level": finding.severity,
        "message": {"text": text},
        "locations": [{"physicalLocation": {"artifactLocation": {"uri": uri}, "region": region}}],
    }
