"""What an update changed, graph by graph."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.cli.diagnostics import say
from kg.cli.output import Column, listing
from kg.render.text import count

if TYPE_CHECKING:
    from kg.pipeline.updating.changes import Updated

_COLUMNS: Final = (Column("graph"), Column("removed"), Column("added"))


def show(updated: Updated, *, dry_run: bool, json: bool) -> None:
    """Write how many triples were removed from and added to each graph, and say what rules made of it."""
    rows = [(name or "default", removed, added) for name, (removed, added) in updated.graphs.items()]
    objects = [
        {"graph": name or None, "removed": removed, "added": added} for name, (removed, added) in updated.graphs.items()
    ]
    listing(_COLUMNS, rows, objects=objects if json else None)
    if not updated.changed:
        say("nothing changes" if dry_run else f"nothing changed; the data is snapshot {updated.snapshot}")
        return
    verb = "would change" if dry_run else "changed"
    say(f"{verb}: {count(updated.removed, 'triple')} removed, {count(updated.added, 'triple')} added")
    if updated.inferred is not None:
        say(f"rules: {updated.inferred_removed} removed, {updated.inferred_added} added ({updated.mode})")
    if not dry_run:
        say(f"the data is now snapshot {updated.snapshot}")
