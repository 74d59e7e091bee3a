"""Lists over the whole store, with facets, order and pages: the view `list`.

`LISTS` has a line for each kind of thing. Its rows are computed once for a snapshot (`kg.views.list_rows`).
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from kg.errors import UsageError
from kg.facts import Location
from kg.settings import Settings, table
from kg.similar import did_you_mean
from kg.views import answers, list_rows, vocabulary
from kg.views.arguments import whole as number
from kg.views.evidence import places
from kg.views.list_queries import query_of
from kg.views.remembered import once

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from kg.store.snapshot import EmbeddedSnapshot

    Row = dict[str, Any]
    Rows = Sequence[Row]

UNCOUNTED: Final = frozenset({"findings", "classes", "properties"})
"""Lists without a total: findings depend on kg.toml too, the vocabulary is counted for completions first."""
_VALUES: Final = 200  # at most so many values of a facet are offered, those of most rows


@dataclass(frozen=True, slots=True)
class List:
    """A kind of list: what makes its rows, its facets by the key of the rows that each is of, which keys `text` is in.

    `objects` makes what other programs read of rows (docs/formats.md) where that is more than the rows themselves.
    """

    rows: Callable[[EmbeddedSnapshot, str], Rows]
    facets: Mapping[str, str]
    words: Sequence[str] = ("name",)
    objects: Callable[[EmbeddedSnapshot, Rows], Rows] | None = None


_OF_CHANNELS: Final = {"type": "types", "package": "packages", "ends": "ends"}
LISTS: Final[Mapping[str, List]] = {
    "nodes": List(
        list_rows.nodes,
        {
            "package": "package",
            "kind": "kind",
            "function": "functions",
            "hardware": "hardware",
            "type": "types",
            "capability": "capabilities",
            "repository": "repository",
            "ros": "ros",
            "language": "language",
        },
        ("node", "package", "description", "plugin"),
        list_rows.node_objects,
    ),
    "packages": List(
        list_rows.packages, {"repository": "repository", "ros": "ros", "deprecated": "deprecated"}, ("name", "folder")
    ),
    "topics": List(partial(list_rows.channels, kind="topic"), _OF_CHANNELS),
    "services": List(partial(list_rows.channels, kind="service"), _OF_CHANNELS),
    "actions": List(partial(list_rows.channels, kind="action"), _OF_CHANNELS),
    "types": List(list_rows.types, {"kind": "kind", "package": "package", "defined": "defined"}),
    "hardware": List(partial(list_rows.classes, of="hardware"), {"kind": "kind"}),
    "functions": List(partial(list_rows.classes, of="functions"), {}),
    "capabilities": List(partial(list_rows.classes, of="capabilities"), {}),
    "systems": List(
        list_rows.systems,
        {"package": "package", "repository": "repository", "ros": "ros", "use": "use", "worst": "worst"},
        ("name", "repository"),
    ),
    "parameters": List(
        list_rows.parameters,
        {
            "package": "package",
            "node": "node",
            "type": "type",
            "access": "access",
            "repository": "repository",
            "name": "name",
        },
        ("name", "node", "description"),
    ),
    "findings": List(
        list_rows.findings,
        {
            "severity": "severity",
            "code": "code",
            "package": "packages",
            "system": "systems",
            "repository": "repository",
        },
        ("message", "systems", "rule"),
    ),
    "classes": List(vocabulary.classes, {"vocabulary": "vocabulary", "parent": "parents"}, ("name", "description")),
    "properties": List(
        vocabulary.properties,
        {"vocabulary": "vocabulary", "subject": "subjects", "value": "values"},
        ("name", "description"),
    ),
}
"""Name to list."""


def totals(snapshot: EmbeddedSnapshot, settings: Settings, *, wait: bool = True) -> dict[str, int]:
    """Return how many rows lists have, without those `UNCOUNTED`, and `message types` the list of types.

    It makes all lists; without `wait` nothing is returned where they have not been made before.
    """

    def make() -> dict[str, int]:
        rows = {of: every_row(snapshot, of, settings.base, "") for of in LISTS if of not in UNCOUNTED}
        messages = sum(row["kind"] == "message" for row in rows["types"])
        return {**{of: len(each) for of, each in rows.items()}, "message types": messages}

    return answers.totals(snapshot, make if wait else None)


def listing(  # noqa: PLR0913 - what a list can be asked
    snapshot: EmbeddedSnapshot,
    settings: Settings,
    *,
    of: str,
    text: str = "",
    sort: str = "",
    offset: str = "0",
    limit: str = "",
    whole: str = "",
    **facets: str,
) -> dict[str, Any]:
    """Return the rows of the list `of` that have all words of `text` and the values of `facets`.

    `sort` is a key of the rows, with `-` before it for the other direction; rows without a value come last. With a
    `limit` (else all rows from `offset` on are there) each row also has `place`, null where it names no file (see
    `kg.views.evidence`). With `whole` (any text) rows are as other programs read them (docs/formats.md).

    The answer has `of`, `all` (how many rows the list has), `total` (how many were chosen), `offset`, `sort`, `query`
    (SPARQL for the chosen rows, None where there is none), `rows`, and `facets`: for each the objects `{"value",
    "count"}` of the values that rows have which fit everything else, the most frequent first.

    Raises UsageError: KG003 for an unknown list, facet or key; KG002 and KG421 for kg.toml (findings).
    """
    kind = LISTS.get(of)
    if kind is None:
        raise UsageError("KG003", f"unknown list `{of}`", hint=f"Valid lists: {', '.join(LISTS)}.")
    given = {name: value.strip() for name, value in facets.items() if value.strip()}
    for name in given:
        if name not in kind.facets:
            hint = did_you_mean(name, kind.facets) or f"Valid filters: {', '.join(kind.facets) or 'none'}."
            raise UsageError("KG003", f"unknown filter `{name}` of {of}", hint=hint)
    allowed = repr(table("lint", Path.cwd())) if of == "findings" else ""
    rows = every_row(snapshot, of, settings.base, allowed)
    words = text.lower().split()
    selected, counts = _chosen(kind, rows, words, given)
    selected = _sorted(selected, sort, rows)
    start, most = number(offset, 0), number(limit, 0)
    shown = selected[start : start + most] if most else selected[start:]
    if whole and kind.objects:
        shown = list(kind.objects(snapshot, shown))
    elif most and not whole:
        shown = list(_placed(snapshot, shown))
    return {
        "of": of,
        "all": len(rows),
        "total": len(selected),
        "offset": start,
        "sort": sort,
        "facets": {name: _offered(counts[name], given.get(name)) for name in kind.facets},
        "query": query_of(of, words, given),
        "rows": shown,
    }


@once
def every_row(snapshot: EmbeddedSnapshot, of: str, base: str, allowed: str) -> Rows:  # noqa: ARG001 - what kg.toml allows is part of what is remembered
    """Return all rows of a list, made once for a snapshot."""
    return LISTS[of].rows(snapshot, base)


def _chosen(
    kind: List, rows: Rows, words: Sequence[str], given: Mapping[str, str]
) -> tuple[list[Row], dict[str, Counter[str]]]:
    """Return the rows that fit, and for each facet how many rows of each value fit all others."""
    counts: dict[str, Counter[str]] = {name: Counter() for name in kind.facets}
    chosen = []
    for row in rows:
        text = " ".join(str(row[key] or "") for key in kind.words).lower() if words else ""
        if not all(word in text for word in words):
            continue
        values = {name: _texts(row[key]) for name, key in kind.facets.items()}
        failed = [name for name, value in given.items() if value not in values[name]]
        if not failed:
            chosen.append(row)
            for name, texts in values.items():
                counts[name].update(texts)
        elif len(failed) == 1:
            counts[failed[0]].update(values[failed[0]])
    return chosen, counts


def _texts(value: Any) -> tuple[str, ...]:
    """Return the facet values of a value: those of a list, none for None, yes or no for a truth value."""
    if value is None or value == "":
        return ()
    if isinstance(value, bool):
        return ("yes" if value else "no",)
    return tuple(map(str, value)) if isinstance(value, list | tuple) else (str(value),)


def _offered(counts: Counter[str], given: str | None) -> list[dict[str, Any]]:
    """Return the values of a facet with their numbers of rows; the one that is given is among them."""
    ordered = sorted(counts.items(), key=lambda one: (-one[1], one[0]))[:_VALUES]
    if given and all(value != given for value, _ in ordered):
        ordered.append((given, counts[given]))
    return [{"value": value, "count": number} for value, number in ordered]


def _sorted(rows: list[Row], sort: str, every: Rows) -> list[Row]:
    key = sort.removeprefix("-")
    if not key or not every:
        return rows
    if key not in every[0]:
        raise UsageError("KG003", f"rows have no `{key}` to sort by", hint=f"Sort by {', '.join(every[0])}.")
    filled = [row for row in rows if row[key] not in (None, "")]
    empty = [row for row in rows if row[key] in (None, "")]
    return sorted(filled, key=lambda row: _order(row[key]), reverse=sort.startswith("-")) + empty


def _order(value: Any) -> tuple[float, str]:
    """Return the sort key of a value: numbers as such, texts and lists of texts as texts, without their case."""
    if isinstance(value, int | float):
        return value, ""
    return 0, (value if isinstance(value, str) else ", ".join(map(str, value))).lower()


def _placed(snapshot: EmbeddedSnapshot, rows: Rows) -> Iterator[Row]:
    """Yield rows with the places of those that name a file."""
    where = places(snapshot)
    for row in rows:
        file = row.get("file")
        source = row.get("repository")
        place = where.evidence(source, Location(file, row.get("line") or 0)) if file and source else None
        yield {**row, "place": place}
