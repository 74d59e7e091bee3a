"""Triples of heads from solutions."""

from __future__ import annotations

from hashlib import blake2b
from typing import TYPE_CHECKING, Final

import numpy as np
from pyoxigraph import BlankNode

from kg.rules.engine.facts import Facts, Keys, distinct, pack, union
from kg.rules.engine.plan import Fresh, Head, HeadNode, RulePlan
from kg.rules.engine.tables import Table, distinct_rows
from kg.rules.engine.terms import IRI, Dictionary
from kg.store.terms import spell

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from kg.rules.form import Rule, Term

_SUBJECTS: Final = np.array([False, True, True, False, False])
"""By kind: IRIs and blank nodes may be subjects."""

_PIECES: Final = 1 << 21


class Collector:
    """Gathers the head's triples of one rule, table by table."""

    def __init__(self, plan: RulePlan, dictionary: Dictionary) -> None:
        self._plan = plan
        self._dictionary = dictionary
        self._keys: dict[int, list[Keys]] = {}

    def add(self, table: Table, heads: Sequence[Head]) -> None:
        """Add the triples of `heads` for each row. What is not a triple of RDF is left out, as CONSTRUCT does."""
        if self._plan.solution:
            table = distinct_rows(table)
        kinds = self._dictionary.kinds
        for head in heads:
            subjects, predicates, objects = (self._column(node, table) for node in head.nodes)
            valid = objects != 0
            if head.subject not in self._plan.resources:
                valid &= _SUBJECTS[kinds(subjects)]
            if not isinstance(head.predicate, int):
                valid &= kinds(predicates) == IRI
            if not valid.all():
                subjects, predicates, objects = subjects[valid], predicates[valid], objects[valid]
            self._put(head, subjects, predicates, objects)

    def _put(self, head: Head, subjects: Keys, predicates: Keys, objects: Keys) -> None:
        keys = pack(subjects, objects)
        if isinstance(head.predicate, int):
            self._append(head.predicate, keys)
            return
        order = np.argsort(predicates, kind="stable")
        predicates, keys = predicates[order], keys[order]
        for predicate in distinct(predicates).tolist():
            begin, end = np.searchsorted(predicates, [predicate, predicate + 1])
            self._append(predicate, keys[begin:end])

    def _append(self, predicate: int, keys: Keys) -> None:
        """Add pairs to a predicate. A large join comes in pieces that derive much the same: they are put together."""
        if not keys.size:
            return
        parts = self._keys.setdefault(predicate, [])
        parts.append(distinct(keys))
        if len(parts) > 1 and sum(part.size for part in parts[1:]) > max(_PIECES, parts[0].size):
            parts[:] = [union(*parts)]

    def _column(self, node: HeadNode, table: Table) -> Keys:
        """Return a node's identifier for each row; 0 where it has none."""
        if isinstance(node, int):
            return np.full(table.rows, node, np.int64)
        if isinstance(node, str):
            return table.columns[node]
        if isinstance(node, Fresh):
            return self._fresh(node, table)
        parts = [self._column(part, table) for part in node]
        return self._triples(parts)

    def _fresh(self, node: Fresh, table: Table) -> Keys:
        """Return a blank node for each row, the same whenever the same rule has the same solution."""
        beginning = _beginning(self._plan.rule, node.label)
        spelt = [self._dictionary.spellings(table.columns[column]) for _, column in self._plan.solution]
        names = [name.encode() for name, _ in self._plan.solution]
        solutions: Iterable[tuple[bytes, ...]] = zip(*spelt, strict=True) if spelt else ((),) * table.rows
        return self._dictionary.intern_all(_label(beginning, names, values) for values in solutions)

    def _triples(self, parts: Sequence[Keys]) -> Keys:
        """Return the triple term of the parts for each row, 0 where they make none."""
        kinds = self._dictionary.kinds
        subjects, predicates, objects = parts
        good = _SUBJECTS[kinds(subjects)] & (kinds(predicates) == IRI) & (objects != 0)
        rows = zip(subjects.tolist(), predicates.tolist(), objects.tolist(), strict=True)
        intern = self._dictionary.intern_triple
        return np.array([intern(*row) if ok else 0 for row, ok in zip(rows, good.tolist(), strict=True)], np.int64)

    def __len__(self) -> int:
        """Return how many triples were gathered, those that came in several pieces counted in each."""
        return sum(part.size for parts in self._keys.values() for part in parts)

    def facts(self) -> Facts:
        """Return the triples gathered."""
        result = Facts()
        for predicate, parts in self._keys.items():
            result.replace(predicate, union(*parts))
        return result


def new_node(rule: Rule, label: str, names: Sequence[str], solution: Mapping[str, Term]) -> BlankNode:
    """Return the node for a blank node of a rule's head in a solution; `names`: the variables that the body binds."""
    ordered = sorted(names)
    values = [spell(solution[name]) if name in solution else b"" for name in ordered]
    return BlankNode(_label(_beginning(rule, label), [name.encode() for name in ordered], values)[2:].decode())


def _beginning(rule: Rule, label: str) -> bytes:
    return f"{rule.name}\n{rule.part}\n{label}\n".encode()


def _label(beginning: bytes, names: Sequence[bytes], values: Sequence[bytes]) -> bytes:
    """Return the spelling of the blank node of a solution: 128 bits, the first digit a letter as engines like it."""
    text = beginning + b"\n".join(b"%s=%s" % pair for pair in zip(names, values, strict=True))
    digest = blake2b(text, digest_size=16).digest()
    return b"_:" + bytes([digest[0] | 0xE0, *digest[1:]]).hex().encode()
