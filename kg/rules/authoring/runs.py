"""Report of a run of rules by file of rules, and which rules account for the triples added and removed."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from pyoxigraph import Literal, NamedNode, Quad, RdfFormat, Store, Triple, parse

from kg.rules.columns import lines, stated, stored
from kg.rules.engine.evaluate import Program, RuleReport, evaluate
from kg.rules.engine.facts import Facts, unpack
from kg.rules.engine.terms import Dictionary
from kg.rules.explain.view import Vocabulary
from kg.rules.form import Rule, is_auxiliary
from kg.store.snapshot import MemorySnapshot

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.rules.engine.limits import Limits
    from kg.rules.remote.running import RemoteReport, StratumReport
    from kg.rules.reports import RunReport

VOCABULARY: Final = Vocabulary(NamedNode("urn:kg:inferred"))
"""The graph of the inferred triples of a world."""


def triples_of(facts: Facts, dictionary: Dictionary) -> Iterator[Triple]:
    """Yield the triples of columns, sorted as text, without those that decomposition introduced."""
    text = b"".join(lines(stored(facts, dictionary), dictionary))
    for quad in parse(b"".join(sorted(text.splitlines(keepends=True))), RdfFormat.N_TRIPLES):
        yield quad.triple


def infer(
    program: Program, triples: Iterable[Triple], limits: Limits | None = None
) -> tuple[list[Triple], list[RuleReport]]:
    """Return what rules infer from triples, and what each rule did; raises what `evaluate` raises."""
    dictionary = Dictionary()
    outcome = evaluate(program, dictionary, stated(triples, dictionary), limits=limits)
    return list(triples_of(outcome.inferred, dictionary)), outcome.reports


def world_of(asserted: Iterable[Triple], inferred: Iterable[Triple]) -> MemorySnapshot:
    """Return asserted and inferred triples, the latter in the graph of `VOCABULARY`."""
    store = Store()
    store.extend(Quad(one.subject, one.predicate, one.object) for one in asserted)
    store.extend(Quad(one.subject, one.predicate, one.object, VOCABULARY.inferred) for one in inferred)
    return MemorySnapshot(store)


@dataclass(frozen=True, slots=True)
class RuleRun:
    """The rules of one file in a run; `derived` counts the triples that one of them was the first to derive."""

    rule: str
    stratum: int
    rounds: int
    derived: int
    seconds: float


def rule_runs(reports: Iterable[RuleReport]) -> list[RuleRun]:
    """Return the run of each file's rules, in the order in which the last of them ran."""
    runs: dict[str, RuleRun] = {}
    for report in reports:
        name = report.rule.name
        before = runs.pop(name, RuleRun(name, 0, 0, 0, 0.0))
        derived = 0 if all(is_auxiliary(atom.predicate) for atom in report.rule.head) else report.derived
        runs[name] = RuleRun(
            name,
            max(before.stratum, report.stratum),
            max(before.rounds, report.rounds),
            before.derived + derived,
            before.seconds + report.seconds,
        )
    return list(runs.values())


def run_objects(report: RunReport, changes: Iterable[Share] = ()) -> Iterator[dict[str, Any]]:
    """Yield a plain object for each rule and one for the run with its `changes`, as docs/formats.md has them."""
    for rule in rule_runs(report.rules):
        yield {**asdict(rule), "seconds": round(rule.seconds, 6)}
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
    strata: dict[int, StratumReport] = {}
    for part in report.strata:
        before = strata.get(part.number)
        if before is None:
            strata[part.number] = part
            continue
        strata[part.number] = replace(
            before,
            rules=tuple(dict.fromkeys((*before.rules, *part.rules))),
            rounds=max(before.rounds, part.rounds),
            derived=before.derived + part.derived,
            seconds=before.seconds + part.seconds,
        )
    return [strata[number] for number in sorted(strata)]


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


@dataclass(frozen=True, slots=True)
class Share:
    """Triples added and removed by some rules: one, or several that derive the same; none for stated triples."""

    rules: tuple[str, ...]
    added: int
    removed: int


def shares(report: RunReport) -> list[Share]:
    """Return the shares of the rules in the difference that a run made, sorted; a first run has one for each rule.

    A triple belongs to the rules whose heads match it. Mostly that is one. If several derive the same property of
    things of the same kind, all of them share it: nothing in the difference shows which it was.
    """
    if report.added == report.inferred and not report.removed and report.rules:
        result = [Share((one.rule,), one.derived, 0) for one in rule_runs(report.rules) if one.derived]
        rest = report.added - sum(share.added for share in result)
        return [*sorted(result, key=lambda share: share.rules), *([Share((), rest, 0)] if rest > 0 else [])]
    heads = _Heads(report.applied, report.change.dictionary)
    counts: dict[tuple[str, ...], list[int]] = {}
    for column, facts in enumerate((report.change.added, report.change.removed)):
        for names, number in heads.owners(facts):
            counts.setdefault(names, [0, 0])[column] += number
    return [Share(names, *counts[names]) for names in sorted(counts)]


class _Heads:
    """The heads of rules by predicate and, where it is a name or a literal, by object."""

    def __init__(self, rules: Iterable[Rule], dictionary: Dictionary) -> None:
        self._heads: dict[int | None, list[tuple[int | None, str]]] = {}
        for rule in rules:
            for head in rule.head:
                predicate = dictionary.intern_term(head.predicate) if isinstance(head.predicate, NamedNode) else None
                ground = isinstance(head.object, NamedNode | Literal)
                value = dictionary.intern_term(head.object) if ground else None  # type: ignore[arg-type] # ground
                self._heads.setdefault(predicate, []).append((value, rule.name))

    def owners(self, facts: Facts) -> Iterator[tuple[tuple[str, ...], int]]:
        """Yield the names of rules that may have derived triples, and of how many triples that holds."""
        for predicate, keys in facts:
            heads = [*self._heads.get(predicate, ()), *self._heads.get(None, ())]
            if all(value is None for value, _ in heads):
                yield _names(heads), int(keys.size)
                continue
            values, numbers = np.unique(unpack(keys)[1], return_counts=True)
            for value, number in zip(values.tolist(), numbers.tolist(), strict=True):
                yield _names(head for head in heads if head[0] in {None, value}), number


def _names(heads: Iterable[tuple[int | None, str]]) -> tuple[str, ...]:
    return tuple(sorted({name for _, name in heads}))
