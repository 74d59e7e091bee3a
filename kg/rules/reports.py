"""Report of a run of rules."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kg.rules.engine.facts import Facts
from kg.rules.engine.terms import Dictionary

if TYPE_CHECKING:
    from kg.rules.engine.evaluate import RuleReport
    from kg.rules.form import Rule


@dataclass(frozen=True, slots=True)
class Seconds:
    """Wall time by phase."""

    read: float = 0.0
    evaluate: float = 0.0
    write: float = 0.0

    @property
    def total(self) -> float:
        """All of it."""
        return self.read + self.evaluate + self.write


@dataclass(frozen=True, slots=True)
class Difference:
    """The inferred triples that a run adds and removes."""

    dictionary: Dictionary
    added: Facts
    removed: Facts


@dataclass(frozen=True, slots=True)
class RunReport:
    """Report of a run; `asserted` counts the triples that rules may read, `inferred` what the graph holds then.

    `mode` is `full` or `incremental`; only a full run reports each rule. `applied` are the rules, cut to the
    schema, `strata` is how many levels they have. `generation` is the one that the run
    made: None when it changed nothing, was a dry run, or is part of a transaction that goes on.
    """

    asserted: int
    inferred: int
    added: int
    removed: int
    seconds: Seconds
    strata: int
    mode: str
    rules: tuple[RuleReport, ...] = field(repr=False)
    change: Difference = field(repr=False)
    applied: tuple[Rule, ...] = field(default=(), repr=False)
    generation: int | None = None
    dry_run: bool = False


def nothing_changed(asserted: int, inferred: int, strata: int) -> RunReport:
    """Return the report of a run that had nothing to do; the counts are those of the last run."""
    change = Difference(Dictionary(), Facts(), Facts())
    return RunReport(asserted, inferred, 0, 0, Seconds(), strata, "incremental", (), change)
