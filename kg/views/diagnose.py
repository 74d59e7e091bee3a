"""Problems of a query, or probably is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kg.query.diagnosis import problems
from kg.views.complete import kept_of

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.interface import Snapshot


def diagnose(snapshot: Snapshot, settings: Settings, text: str = "") -> dict[str, Any]:
    """Return the `problems` of the query `text` (see `kg.query.diagnosis.problems.diagnose`), and the `snapshot`."""
    kept = kept_of(snapshot, settings)
    known = kept.known()
    used = (*known.classes, *known.properties)
    return {"snapshot": snapshot.identity, "problems": problems.diagnose(text, snapshot, kept.prefixes(), used)}
