"""What editors of queries ask: completions at a position, problems, and prefixes that shorten IRIs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from kg.errors import UsageError
from kg.query.completion import service
from kg.query.completion.statistics import SnapshotCache, declared
from kg.query.diagnosis import problems
from kg.query.stored import discover
from kg.store.opening import layout_of
from kg.syntax.names import PREFIXES
from kg.views.remembered import once

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.interface import Snapshot
    from kg.store.snapshot import EmbeddedSnapshot

_declared: Final = once(declared)
_LAST: Final[
    dict[str, SnapshotCache]
] = {}  # what is kept of the snapshot that was asked last, by its store and its identity


def prefixes(snapshot: EmbeddedSnapshot, settings: Settings) -> dict[str, str]:  # noqa: ARG001 - every view is given settings
    """Return prefix to namespace: those predefined in queries, and those that the store declares (`sh:declare`)."""
    return {**_declared(snapshot), **PREFIXES}


def diagnose(snapshot: Snapshot, settings: Settings, text: str = "") -> dict[str, Any]:
    """Return the `problems` of the query `text` (see `kg.query.diagnosis.problems.diagnose`), and the `snapshot`."""
    cache = cache_of(snapshot, settings)
    statistics = cache.cached_statistics()
    used = (*statistics.classes, *statistics.properties)
    return {"snapshot": snapshot.identity, "problems": problems.diagnose(text, snapshot, cache.prefixes(), used)}


def complete(
    snapshot: Snapshot, settings: Settings, text: str = "", position: str | int = -1, fresh: str = ""
) -> dict[str, Any]:
    """Return completions at `position` of the query `text`, in code points; at its end without one.

    The answer is that of `kg.query.completion.service.complete`, with `snapshot`. With `fresh` the store is counted
    if it has changed since it last was, which takes seconds for a large one: faces ask so once, in the background, when
    they start.

    Raises UsageError: KG003 for a position that is not a number.
    """
    try:
        at = int(position)
    except ValueError:
        raise UsageError("KG003", f"the position `{position}` is not a number") from None
    completions = service.complete(
        text,
        len(text) if at < 0 else at,
        cache_of(snapshot, settings),
        lambda: list(discover(settings.queries).values()),
        fresh=bool(fresh),
    )
    return {"snapshot": snapshot.identity, **completions}


def cache_of(snapshot: Snapshot, settings: Settings) -> SnapshotCache:
    """Return the caches of a snapshot: that of this process for the last snapshot, and that of its store."""
    cache = layout_of(settings).cache
    key = f"{cache} {snapshot.identity}"
    if key not in _LAST:
        _LAST.clear()
        _LAST[key] = SnapshotCache(cache, snapshot)
    return _LAST[key].over(snapshot)
