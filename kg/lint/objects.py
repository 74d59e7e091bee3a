"""Findings for other programs: JSON, remarks for SARIF and GitHub, and xUnit in the form of ament linters."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from kg.lazily import lazily
from kg.render.sarif import Remark, Spot

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.lint.finding import Evidence, Finding

with lazily():
    from xml.sax.saxutils import escape, quoteattr  # with a client of HTTP

_NO_XML: Final = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_SUFFIX: Final = ".xunit.xml"


def as_object(finding: Finding) -> dict[str, Any]:
    """Return a finding as plain values (docs/formats.md); `file` is relative to the root of `repository`."""
    place = finding.place
    return {
        "code": finding.code,
        "rule": finding.rule,
        "severity": finding.severity,
        "system": finding.system,
        "message": finding.message,
        "subjects": list(finding.subjects),
        "file": place.path if place else None,
        "line": place.line if place else None,
        "evidence": [_evidence(one) for one in finding.evidence],
        "repository": place.repository if place else None,
        "chain": place.chain or None if place else None,
        "presumes_whole": finding.presumes_whole,
        "also": list(finding.also),
        "hint": finding.hint,
        "replacement": finding.replacement,
        "fingerprint": finding.fingerprint,
    }


def _evidence(place: Evidence) -> dict[str, Any]:
    return {
        "file": place.path,
        "line": place.line,
        "repository": place.repository,
        "words": place.words or None,
        "chain": place.chain or None,
    }


def spelled(place: Evidence, roots: Mapping[str, str], folder: Path) -> str:
    """Return the path of a place relative to `folder` if it is below it, else relative to its source."""
    root = roots.get(place.repository)
    if root:
        file = Path(root) / place.path
        if file.is_relative_to(folder):
            return file.relative_to(folder).as_posix()
    return place.path


def remark(finding: Finding, roots: Mapping[str, str], folder: Path) -> Remark:
    """Return a finding as a remark at its line."""
    spots = [
        Spot(spelled(one, roots, folder), one.line, words=one.words)
        for one in ((finding.place,) if finding.place else ()) + finding.evidence
    ]
    spot, *related = spots or [Spot(finding.system)]
    properties = {"rule": finding.rule, "system": finding.system, "subjects": list(finding.subjects)}
    return Remark(finding.code, finding.severity, finding.message, spot, related, finding.fingerprint, properties)


def suite_name(file: Path) -> str:
    """Return the name of the test for a result file, as in ament: `FOLDER.FILE` without `.xunit.xml`."""
    name = file.name.removesuffix(_SUFFIX) if file.name.endswith(_SUFFIX) else file.stem
    return f"{file.absolute().parent.name}.{name}"


def xunit(findings: Sequence[Finding], name: str, seconds: float, spots: Sequence[str]) -> str:
    """Return findings as the results of a test called `name`; notes pass.

    `spots` are the places of the findings for people. Without failures there is one passing case, since a file without
    cases counts as a test that did not run (ament_lint: `ament_copyright` and similar).
    """
    failed = [(one, spot) for one, spot in zip(findings, spots, strict=True) if one.severity != "note"]
    cases = [_case(one, spot, name) for one, spot in failed] or [
        f'  <testcase name="kg lint" classname={_attribute(name)}/>\n'
    ]
    notes = "".join(f"{spot}: {one.message}\n" for one, spot in zip(findings, spots, strict=True))
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<testsuite name={_attribute(name)} tests="{len(cases)}" errors="0" failures="{len(failed)}" '
        f'time="{seconds:.3f}">\n{"".join(cases)}'
        f"  <system-out>{escape(_NO_XML.sub(' ', notes))}</system-out>\n</testsuite>\n"
    )


def _case(finding: Finding, spot: str, name: str) -> str:
    title = f"{finding.code} {spot}"
    return (
        f"  <testcase name={_attribute(title)} classname={_attribute(name)}>\n"
        f"    <failure message={_attribute(finding.message)}/>\n  </testcase>\n"
    )


def _attribute(text: str) -> str:
    return quoteattr(_NO_XML.sub(" ", text))
