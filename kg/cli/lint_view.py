"""Findings for people: the problem, its line with context, the evidence, and a hint.

error[KG401]: /filter subscribes to /scan, but nothing publishes it; /scan_raw is published
  --> bringup/launch/base.launch:12
   |
12 |   <remap from="scan" to="scan_raw"/>
   = in bringup/launch/base.launch, and in 3 other systems
   = base/src/laser.cpp:71 publishes /scan_raw
help: ...
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.cli.diagnostics import dim, excerpt, head, helps, linked
from kg.codes import CATALOGUE, SEVERITIES
from kg.errors import Place
from kg.facts import Location
from kg.graph.chains import chain_of
from kg.lint.finding import Evidence
from kg.lint.lines import Lines
from kg.lint.objects import spelled
from kg.render.text import count, printable, some

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.cli.links import Links
    from kg.lint.finding import Finding
    from kg.lint.report import Report
    from kg.lint.running import Checked

_MOST_EVIDENCE: Final = 4
"""Maximum number of evidence lines, and of findings of one kind at one line; JSON has them all."""


class LintView:
    """Formats the findings of one report; paths are relative to `folder`."""

    def __init__(self, checked: Checked, links: Links, folder: Path, *, color: bool) -> None:
        self._checked = checked
        self._links = links
        self._lines = Lines(checked.roots)
        self._folder = folder
        self._color = color
        self._helped: set[str] = set()

    def lines(self) -> Iterator[str]:
        """Yield the lines of all findings, separated by empty lines; findings of one kind at one line are grouped."""
        for _, alike in groupby(self._checked.report.findings, _kind):
            first, *others = alike
            yield from self._finding(first, others)
            yield ""

    def _finding(self, finding: Finding, others: Sequence[Finding]) -> Iterator[str]:
        yield head(finding.severity, finding.code, finding.message, color=self._color)
        place = finding.place
        if place is not None:
            shown = Place(self._spelled(place), place.line, excerpt=self._lines.at(place, place.line) or "")
            yield from excerpt(shown, color=self._color, address=self._address(place))
        gutter = " " * len(str(finding.line or ""))
        sign = dim("=", color=self._color)
        yield from (f"{gutter} {sign} {words}" for words in self._remarks(finding))
        yield from (f"{gutter} {sign} and {printable(one.message)}" for one in others[:_MOST_EVIDENCE])
        if len(others) > _MOST_EVIDENCE:
            yield f"{gutter} {sign} and {len(others) - _MOST_EVIDENCE:,} more at this line; --json has them all"
        yield from self._help(finding)

    def _remarks(self, finding: Finding) -> Iterator[str]:
        others = f", and in {count(len(finding.also), 'other system')}" if finding.also else ""
        if others or not finding.in_own_file:
            yield f"in {printable(finding.system)}{others}"
        if finding.place is not None and finding.place.chain:
            yield f"included by {' > '.join(self._steps(finding))}"
        for one in finding.evidence[:_MOST_EVIDENCE]:
            name = self._spelled(one) if one.line is None else f"{self._spelled(one)}:{one.line}"
            where = linked(name, self._address(one), color=self._color)
            yield f"{where} {printable(one.words)}".rstrip()
        if len(finding.evidence) > _MOST_EVIDENCE:
            yield f"and {count(len(finding.evidence) - _MOST_EVIDENCE, 'other line')}; --json has them all"

    def _steps(self, finding: Finding) -> Iterator[str]:
        """Yield the includes that lead to the line to fix."""
        for step in chain_of(finding.place.chain if finding.place else None):
            place = Evidence(step.path, step.line, step.repository or finding.source)
            yield linked(f"{printable(self._spelled(place))}:{place.line}", self._address(place), color=self._color)

    def _help(self, finding: Finding) -> Iterator[str]:
        """Yield the finding's own hint, or that of its code, the latter only once."""
        entry = CATALOGUE.get(finding.code)
        if finding.hint:
            yield from helps(finding.hint, color=self._color)
        elif entry is not None and finding.code not in self._helped:
            self._helped.add(finding.code)
            yield from helps(f"{entry.way_out} (`kg explain {finding.code}`)", color=self._color)

    def _spelled(self, place: Evidence) -> str:
        return spelled(place, self._checked.roots, self._folder)

    def _address(self, place: Evidence) -> str | None:
        return self._links.to(place.repository, Location(place.path, place.line or 1))


def _kind(finding: Finding) -> tuple[object, ...]:
    """Return the key by which findings are grouped: code, rule, severity and line."""
    place = finding.place
    where = (place.repository, place.path, place.line) if place is not None else finding
    return finding.code, finding.rule, finding.severity, where


def summary(checked: Checked) -> Iterator[str]:
    """Yield the summary: number of findings, and stale entries of the allow-list and the baseline."""
    report = checked.report
    sums = Counter(one.severity for one in report.findings)
    totals = ", ".join(count(sums[severity], severity) for severity in SEVERITIES if sums[severity]) or "nothing wrong"
    aside = [
        f"{len(group):,} {words}"
        for group, words in ((report.allowed, "allowed"), (report.baselined, "in the baseline"))
        if group
    ]
    yield f"{count(checked.systems, 'system')} checked: {'; '.join([totals, *aside])}"
    numbers = Counter(one.code for one in report.findings)
    repeated = sorted(code for code, number in numbers.items() if number > 1 and code in CATALOGUE)
    if repeated:
        yield f"{', '.join(f'`kg explain {code}`' for code in repeated)}: details and fixes"


def gone_sources(checked: Checked) -> Iterator[str]:
    """Yield notes about sources that no longer exist on disk, whose lines and comments cannot be read."""
    for one in checked.sources:
        if one.root and not Path(one.root).is_dir():
            consequence = "lines are not shown, and comments that allow are not read"
            yield f"{printable(one.name)} is not in {printable(one.root)} any more: {consequence}"


def leftovers(report: Report) -> Iterator[str]:
    """Yield notes about stale entries of kg.toml and of the baseline, and comments without a reason."""
    for allowance in report.unused:
        yield f"{_near(allowance.place)}: the entry for {allowance.code} matches no finding; remove it"
    for place, code in report.without_reason:
        way = "write the reason after the code"
        yield f"{_near(place)}: the comment gives no reason, so {code} is still reported; {way}"
    if report.gone:
        named = some([printable(f"{one.code} {', '.join(one.subjects)}".strip()) for one in report.gone], 3, "; ")
        entries = count(len(report.gone), "finding")
        yield f"{entries} of the baseline {'is' if len(report.gone) == 1 else 'are'} fixed: {named}"


def _near(place: Place) -> str:
    """Return a place relative to the working folder."""
    path, here = Path(place.path), Path.cwd()
    return str(replace(place, path=str(path.relative_to(here)))) if path.is_relative_to(here) else str(place)
