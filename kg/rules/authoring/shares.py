"""Which rules account for the triples that a run added and removed.

A triple belongs to the rules whose heads match it. Mostly that is one. If several derive the same property of things
of the same kind, all of them share it: nothing in the difference shows which it was.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from pyoxigraph import Literal, NamedNode

from kg.rules.authoring.runs import rule_runs
from kg.rules.engine.facts import unpack

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.rules.engine.facts import Facts
    from kg.rules.engine.terms import Dictionary
    from kg.rules.form import Rule
    from kg.rules.reports import RunReport

__all__ = ["Share", "shares"]


@dataclass(frozen=True, slots=True)
class Share:
    """Triples added and removed by some rules: one, or several that derive the same; none for stated triples."""

    rules: tuple[str, ...]
    added: int
    removed: int


def shares(report: RunReport) -> list[Share]:
    """Return the shares of the rules in the difference that a run made, sorted; a first run has one for each rule."""
    if report.added == report.inferred and not report.removed and report.rules:
        found = [Share((rule.name,), rule.derived, 0) for rule in rule_runs(report.rules) if rule.derived]
        rest = report.added - sum(share.added for share in found)
        return [*sorted(found, key=lambda share: share.rules), *([Share((), rest, 0)] if rest > 0 else [])]
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
