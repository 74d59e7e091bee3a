from __future__ import annotations

from pathlib import Path

from lint.robot import finding

from kg.cli.commands.lint import LintView, gone_sources, summary
from kg.cli.links import Links
from kg.graph.builds import Counts
from kg.graph.source_states import SourceState
from kg.lint.finding import Evidence, Finding
from kg.lint.report import Report
from kg.lint.running import Checked


def lines(*findings: Finding) -> list[str]:
    """Return the findings as drawn, without their sources."""
    checked = Checked(Report(findings), (), 1)
    return list(LintView(checked, Links.of([]), Path("/"), color=False).lines())


def test_findings_of_one_kind_at_one_line_stand_together() -> None:
    """The first is drawn in full, the others add their message; beyond a limit they are counted."""
    alike = [finding(code="X1", message=f"nothing uses /{number}", subjects=(f"/{number}",)) for number in range(7)]
    assert lines(*alike) == [
        "warning[X1]: nothing uses /0",
        "  --> bringup/launch/base.launch:3",
        *(f"  = and nothing uses /{number}" for number in range(1, 5)),
        "  = and 2 more; --json has them all",
        "",
    ]


def test_another_line_is_another_finding() -> None:
    """Findings at different lines are drawn separately, each followed by an empty line."""
    other = finding(code="X1", place=Evidence("bringup/launch/base.launch", 4, "local/rover"))
    assert lines(finding(code="X1"), other).count("") == 2


def test_parameters_that_a_node_never_reads_are_one_group() -> None:
    """Findings about parameters of one node in one file are drawn once; the others add their message and line."""
    rule = "architecture/parameter-not-read"
    unread = [
        finding(
            rule=rule,
            message=f"{node} never reads {node}/{name}",
            subjects=(f"{node}/{name}", node),
            place=Evidence("bringup/launch/base.launch", line, "local/rover"),
        )
        for line, node, name in ((3, "/base", "a"), (4, "/arm", "a"), (5, "/base", "b"))
    ]
    drawn = lines(*unread)
    assert [one for one in drawn if "never reads" in one and "=" not in one] == [
        "warning[KG407]: /base never reads /base/a",
        "warning[KG407]: /arm never reads /arm/a",
    ]
    assert "  = and /base never reads /base/b (line 5)" in drawn


def test_evidence_beyond_some_lines_is_counted() -> None:
    """Beyond a limit, evidence is counted, with the way to see the rest."""
    evidence = tuple(Evidence("a.cpp", number, "local/rover", "publishes /a") for number in range(1, 8))
    drawn = lines(finding(code="X1", evidence=evidence, hint="so"))
    assert drawn[2:] == [
        *(f"  = a.cpp:{number} publishes /a" for number in range(1, 5)),
        "  = and 3 other lines; --json has them all",
        "help: so",
        "",
    ]


def test_includes_are_files_of_their_own_sources(tmp_path: Path) -> None:
    """Each include on the way is shown by its path on disk, also if it is in another source than the launch file."""
    sources = {"local/rover": tmp_path / "rover", "local/nav": tmp_path / "nav"}
    checked = Checked(
        Report(
            (
                finding(
                    source="local/rover",
                    place=Evidence("nav/a.py", 7, "local/nav", chain="rover/all.py:3 > local/nav//nav/bringup.py:5"),
                ),
            )
        ),
        tuple(
            SourceState(name, None, None, None, False, str(root), None, None, Counts())
            for name, root in sources.items()
        ),
        1,
    )
    drawn = LintView(checked, Links.of([]), tmp_path, color=False).lines()
    assert "included by rover/rover/all.py:3 > nav/nav/bringup.py:5" in "\n".join(drawn)


def test_the_sum_counts_by_severity() -> None:
    """The sum counts findings by severity, followed by the allowed and the baseline ones."""
    found = Report((finding(severity="error"), finding()), allowed=(finding(),), baselined=(finding(), finding()))
    assert list(summary(Checked(found, (), 3))) == [
        "3 systems checked: 1 error, 1 warning; 1 allowed; 2 in the baseline",
        "`kg explain KG407`: details and fixes",
    ]


def test_the_sum_counts_the_groups_if_several_findings_share_one() -> None:
    """Findings of one kind at one line are shown together, so the sum has the number of groups as well."""
    place = Evidence("a.launch", 3, "local/nav")
    alike = [finding(place=place, subjects=(name,)) for name in ("/a", "/b")]
    first, *_ = summary(Checked(Report((*alike, finding(severity="error"))), (), 3))
    assert first == "3 systems checked: 1 error, 2 warnings in 2 groups"


def test_a_check_without_launch_files_is_no_success() -> None:
    """Where no launch file was found, the sum says so instead of `nothing wrong`."""
    assert list(summary(Checked(Report(), (), 0))) == ["0 systems checked: no launch files found"]


def test_codes_that_were_found_more_than_once_are_named_at_the_end() -> None:
    """The help of a code is shown at its first finding only; codes of user rules have none."""
    found = Report((finding(), finding(subjects=("/b",)), finding(code="X1"), finding(code="X1", subjects=("/b",))))
    assert list(summary(Checked(found, (), 1)))[1:] == ["`kg explain KG407`: details and fixes"]


def test_sources_that_are_gone_are_told(tmp_path: Path) -> None:
    """A missing source is reported because its lines cannot be shown; sources without a known folder are skipped."""
    roots = {"a": str(tmp_path), "b": None, "c": str(tmp_path / "c")}
    states = [SourceState(name, None, None, None, False, root, None, None, Counts()) for name, root in roots.items()]
    assert list(gone_sources(Checked(Report(), tuple(states), 1))) == [
        f"c is not in {tmp_path / 'c'} any more: lines are not shown, and comments that allow are not read"
    ]
