"""The view `named`: search in the names of all lists."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from heapq import nsmallest
from typing import TYPE_CHECKING, Any, Final

from kg.views.arguments import whole
from kg.views.listing import every_row
from kg.views.lists import LISTS
from kg.views.remembered import once

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

_MOST: Final = 100
_SHORTEST: Final = 2  # one character is part of nearly every name
_PART: Final = 4  # the rank of names that have the text somewhere
_CHANNELS: Final = {"topics", "services", "actions"}
_CLASSES: Final = {"hardware", "functions", "capabilities"}
_DETAILS: Final = {"nodes": "package", "packages": "repository", "types": "kind", "systems": "repository"}
_ORDER: Final = ("packages", "nodes", "topics", "services", "actions", "types", "systems", *_CLASSES, "parameters")
"""Lists by what a name alone means most; findings have no names."""


@dataclass(frozen=True, slots=True)
class _Named:
    """A thing: `shown`, `text` and `last` (its name, and the last segment of it) in lower case, and how many use it."""

    text: str
    last: str
    uses: int
    shown: dict[str, Any]


def named(snapshot: EmbeddedSnapshot, settings: Settings, *, text: str, limit: str = "8") -> dict[str, Any]:
    """Return the things whose name has all words of `text`, the best `limit` (at most 100) of `total`.

    Equal names come first, then equal last segments (`cmd_vel`, `LaserScan`, `bringup_launch.py`), then names that
    begin with the text. Each of `names` has `of` (its list), `name`, `detail` (package, source, types, or number of
    nodes) and `iri`, that of one node for parameters, which are here once a name.
    """
    asked = " ".join(text.lower().split())
    if len(asked) < _SHORTEST:
        return {"text": text, "total": 0, "names": []}
    names = _all(snapshot, settings.base)
    ranked = sorted(
        (rank, _ORDER.index(one.shown["of"]), -one.uses, len(one.text), one.text, at)
        for at, one in enumerate(names)
        if (rank := _rank(one, asked)) is not None
    )
    # The same name in other namespaces follows all that fit as well: `/robot2/scan` says little more than `/scan`.
    seen: set[tuple[int, str]] = set()
    for place, (rank, order, uses, length, own, at) in enumerate(ranked):
        if (order, names[at].last) in seen:
            ranked[place] = (max(rank, _PART), order, uses, length, own, at)
        seen.add((order, names[at].last))
    best = nsmallest(min(whole(limit, 8), _MOST), ranked)
    return {"text": text, "total": len(ranked), "names": [names[at].shown for *_, at in best]}


def _rank(one: _Named, asked: str) -> int | None:
    """Return how well a name fits, 0 the best; None if a word is missing in it."""
    if asked in one.text:
        plain = asked.strip("/")
        fits = (one.text.strip("/") == plain, one.last == plain, one.last.startswith(plain), one.text.startswith(asked))
        return next((rank for rank, fit in enumerate(fits) if fit), _PART)
    words = asked.split()
    return _PART + 1 if len(words) > 1 and all(word in one.text for word in words) else None


@once
def _all(snapshot: EmbeddedSnapshot, base: str) -> list[_Named]:
    return [one for of in LISTS if of in _ORDER for one in _of(snapshot, base, of)]


def _of(snapshot: EmbeddedSnapshot, base: str, of: str) -> Iterator[_Named]:
    key = LISTS[of].columns[0].key
    listed = [row for row in every_row(snapshot, of, base, "") if row[key]]
    if of == "parameters":
        uses = Counter(row["name"] for row in listed)
        listed = list({row["name"]: {**row, "nodes": uses[row["name"]]} for row in listed}.values())
    for row in listed:
        name, number = row[key], _uses(of, row)
        shown = {"of": of, "name": name, "detail": _detail(of, row), "iri": row["iri"]}
        yield _Named(name.lower(), name.lower().rpartition("/")[2], number, shown)


def _uses(of: str, row: dict[str, Any]) -> int:
    if of == "nodes":
        return sum(int(row[role]) for role in ("publishes", "subscribes", "services", "clients", "actions"))
    return int(row["giving"] + row["taking"] if of in _CHANNELS else row["nodes"])


def _detail(of: str, row: dict[str, Any]) -> str:
    if of in _CHANNELS:
        return ", ".join(row["types"])
    if of in _DETAILS:
        return str(row[_DETAILS[of]] or "")
    return f"{row['nodes']} {'node' if row['nodes'] == 1 else 'nodes'}"
