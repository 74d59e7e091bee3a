"""Findings on the wiring of launch files: the view `lint`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from kg.codes import CATALOGUE
from kg.facts import Location
from kg.graph import vocabulary as v
from kg.graph.iris import Iris
from kg.lint.allowing import Comments, allowances
from kg.lint.objects import as_object
from kg.lint.question import Question
from kg.lint.reading import read_findings
from kg.lint.report import Choice, report
from kg.lint.running import check
from kg.settings import table
from kg.views.evidence import places
from kg.views.names import known_package
from kg.views.node_rows import fact
from kg.views.systems import included_names, system_named

if TYPE_CHECKING:
    from kg.graph.systems_reading import SystemName
    from kg.lint.finding import Evidence, Finding
    from kg.lint.report import Report
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot
    from kg.views.evidence import Places

_TYPE: Final = v.bare(v.TYPE)
_FINDING: Final = f"{v.RNKG}Finding"


def lint(  # noqa: PLR0913 - what is looked at
    snapshot: EmbeddedSnapshot,
    settings: Settings,
    *,
    system: str = "",
    package: str = "",
    repository: str = "",
    level: str = "note",
) -> dict[str, Any]:
    """Return the findings of `kg lint` on one `system` (as the view of that name takes it), of a `package`, or of all.

    `level` is the least severity: error, warning or note. The answer is `{"findings", "allowed", "systems"}`: what is
    reported, how many findings kg.toml and comments allow, how many configurations were looked at. A finding has the
    keys of `kg lint --json` (docs/formats.md), and `iri`, `place` (where to mend it, as
    `kg.views.evidence.Places.evidence`, with `words`, `chain`, `line_text` and `line_stored`), `evidence` (a list
    of the same), `way_out` (what to do about findings of its code) and `fact`, which the view `why` proves.

    Raises:
        UnknownNameError: KG422 and KG001 for an unknown system and package.
        UsageError: KG002 and KG421 for kg.toml, KG003 for an ambiguous name of a system.
    """
    least = level if level in {"error", "warning", "note"} else "note"
    if system:
        name = system_named(snapshot, system, repository, settings.base)
        found, looked_at = system_report(snapshot, settings, name, least), 1
    else:
        if package:
            known_package(snapshot, package)
        checked = check(snapshot, Question(package=package or None, level=least), settings, Path.cwd())
        found, looked_at = checked.report, checked.systems
    where = places(snapshot)
    return {
        "findings": finding_objects(found.findings, where),
        "allowed": len(found.allowed),
        "systems": looked_at,
    }


def system_report(snapshot: EmbeddedSnapshot, settings: Settings, name: SystemName, level: str = "note") -> Report:
    """Return the findings on one configuration; others are not read."""
    configuration = Iris(settings.base).configuration(name.repository, name.path)
    findings = read_findings(snapshot, settings.base, configuration)
    where = places(snapshot)
    roots = {one: state.root for one, state in where.sources.items() if state.root}
    entries = allowances(table("lint", Path.cwd()), {one.code for one in findings})
    choice = Choice(frozenset({name.name}), level=level)
    included = included_names(snapshot)
    return report(findings, choice, included=included, entries=entries, comments=Comments(roots))


def finding_objects(findings: tuple[Finding, ...], where: Places) -> list[dict[str, Any]]:
    """Return findings as faces show them; see `lint`."""
    return [_finding(one, where) for one in findings]


def _finding(finding: Finding, where: Places) -> dict[str, Any]:
    entry = CATALOGUE.get(finding.code)
    return {
        **as_object(finding),
        "iri": finding.iri,
        "place": _place(finding.place, where) if finding.place else None,
        "evidence": [_place(one, where) for one in finding.evidence],
        "way_out": entry.way_out if entry else None,
        "fact": fact(finding.iri, _TYPE, _FINDING),
    }


def _place(place: Evidence, where: Places) -> dict[str, Any]:
    location = Location(place.path, place.line or 0)
    return {
        **where.evidence(place.repository, location),
        "words": place.words or None,
        "chain": place.chain or None,
        **where.code(place.repository, location),
    }
