"""The graph against references: what it contains of them (Table 8), and how right its relations are (Table 10)."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Final

from kg.evaluate.linking import Ground, Linker
from kg.evaluate.references import PARAMETERS, Choice, Gathered, gather
from kg.evaluate.tables import Cell, Share, Table, wilson, with_paper
from kg.facts import Role
from kg.render.text import count

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from kg.store.interface import Snapshot

_QUERY: Final = "completeness/reference-entities"
_ENTITIES: Final = ("node", "topic", "service", "action", "parameter", "message type", "service type", "action type")
_ALL: Final = "all"


def completeness(snapshot: Snapshot, paths: Sequence[Path], choice: Choice) -> tuple[Table, Ground]:
    """Return the table for a store and references, and the links of all references together.

    Raises UsageError: KG721 an unreadable file, KG723 a page of an unknown package.
    """
    gathered, linked = grounds(snapshot, paths, choice)
    rows = [
        row
        for name, ground in linked
        for row in _entity_rows(name, {entity: (n["named"], n["known"]) for entity, n in ground.counts(_QUERY).items()})
    ]
    table = Table(
        "completeness",
        "Entities of references in the graph",
        ("reference", "entity", "known"),
        tuple(rows),
        tuple(remarks(gathered, linked[-1][1])),
    )
    return with_paper(table, ("entity",)), linked[-1][1]


def grounds(
    snapshot: Snapshot, paths: Sequence[Path], choice: Choice
) -> tuple[tuple[Gathered, ...], list[tuple[str, Ground]]]:
    """Return the gathered references of each path, and the links of each; for several paths also of all together."""
    gathered = gather(snapshot, paths, choice)
    linker = Linker(snapshot)
    linked = [(one.path.name, linker.link(one.references)) for one in gathered if len(gathered) > 1]
    name = _ALL if len(gathered) > 1 else gathered[0].path.name
    return gathered, [*linked, (name, linker.link(each for one in gathered for each in one.references))]


def share(part: int, whole: int) -> Share:
    """Return a share with its Wilson interval."""
    return Share(part, whole, wilson(part, whole) if whole else None)


def _entity_rows(reference: str, counts: dict[str, tuple[int, int]]) -> Iterator[tuple[Cell, ...]]:
    for entity in _ENTITIES:
        named, matched = counts.get(entity, (0, 0))
        if named:
            yield reference, entity, share(matched, named)


def remarks(gathered: Iterable[Gathered], ground: Ground) -> Iterator[str]:
    """Yield remarks on what was compared, and what was left out with reasons."""
    repositories = {one.reference.repository for one in ground.linked}
    nodes = count(len(ground.linked), "documented node")
    yield f"{nodes} of {count(len(repositories), 'repository', 'repositories')} compared."
    left_out: Counter[str] = Counter()
    for one in gathered:
        left_out.update(one.left_out)
    if left_out:
        reasons = "; ".join(f"{number:,} {reason}" for reason, number in left_out.most_common())
        yield f"Left out: {reasons}."


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

    Raises UsageError: KG721 an unreadable file, KG723 a page of an unknown package.
    """
    gathered, linked = grounds(snapshot, paths, choice)
    rows = tuple(row for name, ground in linked for row in _relation_rows(name, ground))
    notes = [*remarks(gathered, linked[-1][1]), _TYPED]
    if any(row[2] is None for row in rows):
        notes.append(_OPEN)
    columns = ("reference", "relation", "precision", "recall", "F1")
    table = Table("correctness", "Relations of the graph against references", columns, rows, tuple(notes))
    return with_paper(table, ("relation",)), linked[-1][1]


def _relation_rows(reference: str, ground: Ground) -> Iterator[tuple[Cell, ...]]:
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
