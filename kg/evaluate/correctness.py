"""Table 10: precision, recall and F1 of the graph's relations against references."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.evaluate.completeness import grounds, remarks, share
from kg.evaluate.references import PARAMETERS
from kg.evaluate.tables import Cell, Share, Table, with_paper
from kg.facts import Role

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from kg.evaluate.gathering import Choice
    from kg.evaluate.linking import Ground
    from kg.store.interface import Snapshot

_RECALL: Final = "correctness/reference-recall"
_PRECISION: Final = "correctness/reference-precision"
_TYPES: Final = "correctness/reference-types"
_RELATIONS: Final = {**{role.relation: str(role) for role in Role}, "has parameter": PARAMETERS}
"""The relations of RNKG by the roles of references."""
_OPEN: Final = (
    "No precision without references that name all that a node has (`closed_world` in the file, or --closed): what "
    "they do not name may still be right."
)
_TYPED: Final = "`has type`: recall of names with their types; precision of the types of ends that were found."


def correctness(snapshot: Snapshot, paths: Sequence[Path], choice: Choice) -> tuple[Table, Ground]:
    """Return the table for a store and references, and the links of all references together.

    Raises:
        UsageError: KG721 an unreadable file, KG723 a page of an unknown package.
    """
    gathered, linked = grounds(snapshot, paths, choice)
    rows = tuple(row for name, ground in linked for row in _rows(name, ground))
    notes = [*remarks(gathered, linked[-1][1]), _TYPED]
    if any(row[2] is None for row in rows):
        notes.append(_OPEN)
    columns = ("reference", "relation", "precision", "recall", "F1")
    table = Table("correctness", "Relations of the graph against references", columns, rows, tuple(notes))
    return with_paper(table, ("relation",)), linked[-1][1]


def _rows(reference: str, ground: Ground) -> Iterator[tuple[Cell, ...]]:
    recalled, claimed = ground.counts(_RECALL), ground.counts(_PRECISION)
    for relation, role in _RELATIONS.items():
        if role in recalled:
            precision = _share(claimed, (role,), "confirmed", "stated")
            yield _row(reference, relation, precision, _share(recalled, (role,), "had", "stated"))
    roles = [role for role in _RELATIONS.values() if role in recalled]
    every = _share(claimed, roles, "confirmed", "stated")
    yield _row(reference, "all of these", every, _share(recalled, roles, "had", "stated"))
    types = ground.counts(_TYPES)
    precision = _share(types, types, "same", "typed")
    yield _row(reference, "has type", precision, _share(recalled, roles, "had_with_type", "stated_with_type"))


def _share(counts: Mapping[str, Mapping[str, int]], roles: Iterable[str], part: str, whole: str) -> Share | None:
    """Return the share of all these roles together; None without any entries."""
    chosen = [counts[role] for role in roles if role in counts]
    number = sum(one[whole] for one in chosen)
    return share(sum(one[part] for one in chosen), number) if number else None


def _row(reference: str, relation: str, precision: Share | None, recall: Share | None) -> tuple[Cell, ...]:
    right, complete = (one.value if one else None for one in (precision, recall))
    harmonic = None
    if right is not None and complete is not None:
        harmonic = 2 * right * complete / (right + complete) if right + complete else 0.0
    return reference, relation, precision, recall, harmonic
