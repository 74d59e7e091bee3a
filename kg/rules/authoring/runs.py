"""Report of a run of rules for each file of rules, for people and programs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from kg.rules.form import is_auxiliary

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.rules.authoring.shares import Share
    from kg.rules.engine.evaluate import RuleReport
    from kg.rules.remote.running import RemoteReport, StratumReport
    from kg.rules.reports import RunReport

__all__ = ["RuleRun", "remote_objects", "remote_strata", "rule_runs", "run_objects"]


@dataclass(frozen=True, slots=True)
class RuleRun:
    """The rules of one file in a run; `derived` counts the triples that one of them was the first to derive."""

    name: str
    stratum: int
    rounds: int
    derived: int
    seconds: float


def rule_runs(reports: Iterable[RuleReport]) -> list[RuleRun]:
    """Return the run of each file's rules, in the order in which the last of them ran."""
    found: dict[str, RuleRun] = {}
    for report in reports:
        name = report.rule.name
        before = found.pop(name, RuleRun(name, 0, 0, 0, 0.0))
        derived = 0 if all(is_auxiliary(atom.predicate) for atom in report.rule.head) else report.derived
        found[name] = RuleRun(
            name,
            max(before.stratum, report.stratum),
            max(before.rounds, report.rounds),
            before.derived + derived,
            before.seconds + report.seconds,
        )
    return list(found.values())


def run_objects(report: RunReport, changes: Iterable[Share] = ()) -> Iterator[dict[str, Any]]:
    """Yield a plain object for each rule and one for the run with its `changes`, as docs/formats.md has them."""
    for rule in rule_runs(report.rules):
        yield {
            "rule": rule.name,
            "stratum": rule.stratum,
            "rounds": rule.rounds,
            "derived": rule.derived,
            "seconds": round(rule.seconds, 6),
        }
    phases = report.seconds
    yield {
        "run": True,
        "asserted": report.asserted,
        "inferred": report.inferred,
        "seconds": round(phases.total, 6),
        "strata": report.strata,
        "mode": report.mode,
        "added": report.added,
        "removed": report.removed,
        "changes": [{"rules": list(share.rules), "added": share.added, "removed": share.removed} for share in changes],
        "dry_run": report.dry_run,
        "phases": {
            "read": round(phases.read, 6),
            "evaluate": round(phases.evaluate, 6),
            "write": round(phases.write, 6),
        },
    }


def remote_strata(report: RemoteReport) -> list[StratumReport]:
    """Return the results of each stratum of a run on a server, for all rules that ran together."""
    found: dict[int, StratumReport] = {}
    for part in report.strata:
        before = found.get(part.number)
        found[part.number] = part if before is None else _joined(before, part)
    return [found[number] for number in sorted(found)]


def _joined(one: StratumReport, other: StratumReport) -> StratumReport:
    return replace(
        one,
        rules=tuple(dict.fromkeys((*one.rules, *other.rules))),
        rounds=max(one.rounds, other.rounds),
        derived=one.derived + other.derived,
        seconds=one.seconds + other.seconds,
    )


def remote_objects(report: RemoteReport) -> Iterator[dict[str, Any]]:
    """Yield a plain object for each stratum of a run on a server and one for the run."""
    strata = remote_strata(report)
    for stratum in strata:
        yield {
            "rules": sorted(set(stratum.rules)),
            "stratum": stratum.number,
            "rounds": stratum.rounds,
            "derived": stratum.derived,
            "seconds": round(stratum.seconds, 6),
        }
    yield {
        "run": True,
        "inferred": report.inferred,
        "seconds": round(report.seconds, 6),
        "strata": len(strata),
        "mode": "full",
    }
