from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest
from lint.robot import finding

from kg.errors import Place
from kg.lint.allowing import Allowance, Comments
from kg.lint.finding import Evidence
from kg.lint.report import Choice, merged, report

if TYPE_CHECKING:
    from kg.lint.finding import Finding
    from kg.lint.report import Report

BASE, ALL, SIM = (f"bringup/launch/{name}.launch" for name in ("base", "all", "sim"))


def told(findings: list[Finding], choice: Choice | None = None, **more: Any) -> Report:
    """Return the report about findings with `base.launch` included."""
    known: dict[str, Any] = {"included": {BASE}, "entries": [], "comments": Comments({})}
    return report(findings, choice or Choice(), **(known | more))


def test_one_fault_in_several_systems_is_told_once() -> None:
    """It is reported for the system whose file has the line, and names the others."""
    alike = [finding(system=system) for system in (ALL, BASE, SIM)]
    (one,) = merged(alike)
    assert (one.system, one.also) == (BASE, (ALL, SIM))


@pytest.mark.parametrize(
    "other",
    [{"subjects": ("/b",)}, {"code": "KG406"}, {"severity": "note"}, {"place": Evidence(BASE, 4, "local/rover")}],
)
def test_different_faults_stay_apart(other: dict[str, Any]) -> None:
    """Another subject, code, severity or line is another fault."""
    assert len(merged([finding(), finding(system=ALL, **other)])) == 2


def test_undeclared_arguments_of_a_file_are_one_note() -> None:
    """Notes about arguments that one file reads without declaring them are one, at its first line; errors are not."""
    rule = "architecture/undeclared-argument"
    findings = [
        finding(
            code="KG413",
            rule=rule,
            severity="note",
            message="read",
            subjects=(f"a{line}",),
            place=Evidence(path, line, "local/rover"),
            evidence=(),
        )
        for path, line in ((BASE, 9), (BASE, 3), (BASE, 12), (BASE, 5), (BASE, 7), (SIM, 1))
    ]
    one, other = merged(findings)
    assert str(one.place) == f"{BASE}:3"
    assert one.message == "5 arguments are read and not declared: 'a3', 'a5', 'a7', 'a9', ..."
    assert [str(place) for place in one.evidence] == [f"{BASE}:{line}" for line in (5, 7, 9, 12)]
    assert other.message == "read"
    assert len(merged([replace(each, severity="error") for each in findings])) == 6


def test_findings_without_a_line_stay_apart_by_system() -> None:
    """If the rule names no line, each system is reported."""
    assert len(merged([finding(place=None), finding(place=None, system=ALL)])) == 2


def test_what_presumes_the_whole_is_not_told_of_what_is_included() -> None:
    """Findings about incomplete systems are omitted for included files, unless requested or named."""
    findings = [finding(presumes_whole=True), finding(presumes_whole=True, system=ALL, subjects=("/b",))]
    assert [one.system for one in told(findings).findings] == [ALL]
    assert len(told(findings, Choice(every=True)).findings) == 2
    assert [one.system for one in told(findings, Choice(frozenset({BASE}))).findings] == [BASE]


def test_findings_are_chosen_by_level_and_code() -> None:
    """Findings below the level, or of another code, are omitted."""
    findings = [
        replace(finding(), code=code, severity=severity)
        for code, severity in (("KG412", "error"), ("KG401", "warning"), ("KG406", "note"))
    ]
    assert [one.code for one in told(findings, Choice(level="warning")).findings] == ["KG412", "KG401"]
    assert [one.code for one in told(findings, Choice(codes=frozenset({"KG406"}))).findings] == ["KG406"]


@pytest.mark.parametrize(("severity", "failed"), [("error", True), ("warning", True), ("note", False)])
def test_notes_are_no_failure(severity: str, failed: bool) -> None:  # noqa: FBT001 - a case
    """Notes do not set the exit code, but errors and warnings do."""
    assert told([finding(severity=severity)]).failed is failed


def test_an_allowance_of_what_was_not_asked_for_is_not_unused() -> None:
    """Unused entries are determined from all findings, including filtered ones."""
    entry = Allowance("KG407", "so", Place("kg.toml", 1))
    assert told([finding()], Choice(level="error"), entries=[entry]).unused == ()
    assert told([finding(code="KG401")], entries=[entry]).unused == (entry,)
