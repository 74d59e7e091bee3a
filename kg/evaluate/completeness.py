"""Table 8: the share of the references' entries that the graph contains."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Final

from kg.evaluate.gathering import Choice, Gathered, gather
from kg.evaluate.intervals import wilson
from kg.evaluate.linking import Ground, Linker
from kg.evaluate.tables import Cell, Share, Table, with_paper
from kg.render.text import count

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from kg.store.interface import Snapshot

_QUERY: Final = "completeness/reference-entities"
_ENTITIES: Final = (
    "node",
    "topic",
    "service",
    "action",
    "parameter",
    "message type",
    "service type",
    "action type",
)
_ALL: Final = "all"


def completeness(snapshot: Snapshot, paths: Sequence[Path], choice: Choice) -> tuple[Table, Ground]:
    """Return the table for a store and references, and the links of all references together.

    Raises:
        UsageError: KG721 an unreadable file, KG723 a page of an unknown package.
    """
    gathered, linked = grounds(snapshot, paths, choice)
    rows = [
        row
        for name, ground in linked
        for row in _rows(name, {entity: (n["named"], n["known"]) for entity, n in ground.counts(_QUERY).items()})
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


def _rows(reference: str, counts: dict[str, tuple[int, int]]) -> Iterator[tuple[Cell, ...]]:
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
