"""Search: nodes by function, needs and wiring, with the reasons and their lines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from kg.errors import UsageError
from kg.facts import Location
from kg.search.names import filter_values
from kg.search.options import FILTERS
from kg.search.searching import Hit, Search, hit_object, search_of
from kg.search.wording import advice, understood, unknown
from kg.similar import did_you_mean
from kg.store.opening import layout_of
from kg.views.arguments import whole
from kg.views.evidence import Places, places
from kg.views.remembered import once

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

_MOST: Final = 100
_opened: Final = once(search_of)


def find(
    snapshot: EmbeddedSnapshot, settings: Settings, text: str = "", limit: str = "20", **filters: str
) -> dict[str, Any]:
    """Return the nodes that match `text` and all `filters` (`kg.search.options.FILTERS`).

    Several values of one filter are separated by commas. `limit` is at most 100. The answer has `text`, `filters`,
    `total`, `only` and `rather` (what the words were taken for, as strict and as loose wishes), `advice` (a sentence,
    where nothing was found), `fits` (false where the hits are only the nearest),
    `unknown` (sentences about the words that describe no node) and `hits`: objects as of `kg search --json` with `iri`,
    `evidence` of the node, and in each of `reasons` an `evidence` or None.

    Raises:
        UsageError: KG003 for an unknown filter, or nothing to search for; KG701, KG702, KG703 for a
            value that no node has.
    """
    given = {
        name: [one.strip() for one in value.split(",") if one.strip()]
        for name, value in filters.items()
        if value.strip()
    }
    for name in given:
        if name not in FILTERS:
            hint = did_you_mean(name, FILTERS) or f"Valid filters: {', '.join(FILTERS)}."
            raise UsageError("KG003", f"unknown filter `{name}`", hint=hint)
    if not text.strip() and not given:
        raise UsageError("KG003", "nothing to search for", hint="Give words or a filter.")
    if not 0 < whole(limit, 0) <= _MOST:
        raise UsageError("KG003", f"`{limit}` is not a valid limit", hint=f"Give a whole number from 1 to {_MOST}.")
    search = search_over(snapshot, settings)
    answer = search.find(text, given, int(limit))
    only, rather = understood(answer.need)
    where = places(snapshot)
    return {
        "text": text,
        "filters": given,
        "total": answer.total,
        "only": only,
        "rather": rather,
        "advice": None if answer.hits else advice(answer.need, search),
        "fits": answer.fits,
        "unknown": unknown(answer.need),
        "hits": [_hit(hit, where) for hit in answer.hits],
    }


def choices(snapshot: EmbeddedSnapshot, settings: Settings) -> dict[str, list[str]]:
    """Return for each filter the values that nodes of the store have, sorted."""
    names = search_over(snapshot, settings).names
    return {kind: filter_values(kind, names) for kind in FILTERS}


def search_over(snapshot: EmbeddedSnapshot, settings: Settings) -> Search:
    """Return the search over a snapshot, whose index is built where the store does not keep it yet."""
    return _opened(snapshot, layout_of(settings).cache)


def _hit(hit: Hit, where: Places) -> dict[str, Any]:
    data = hit_object(hit)
    repository = hit.package.repository
    for reason in data["reasons"]:
        path, line = reason.pop("file"), reason.pop("line")
        reason["evidence"] = None if path is None else where.evidence(repository, Location(path, line))
    also = [{**named, "iri": one.iri} for named, (_, one) in zip(data["also"], hit.others, strict=True)]
    declared = where.evidence(repository, Location(hit.node.path, hit.node.line))
    return {**data, "iri": hit.node.iri, "evidence": declared, "also": also}
