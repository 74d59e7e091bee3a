"""`kg search`: nodes by what they do, need and are wired to, with the reasons."""

import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated, Final

import typer

from kg.cli.completion import features
from kg.cli.diagnostics import note
from kg.cli.numbers import whole
from kg.cli.options import Json, PackageName, with_options, with_settings
from kg.cli.output import Column, listing, terminal
from kg.cli.search_view import narrow, report_reading, row, show_hits
from kg.errors import Exit, UsageError
from kg.lazily import lazily
from kg.render.text import count
from kg.search.options import FILTERS
from kg.settings import Settings
from kg.store.opening import existing, reading, reading_with_cache

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.search.searching import Search

with lazily():
    from kg.cli.links import Links
    from kg.graph.source_states import sources
    from kg.search.searching import hit_object, open_search, search_of
    from kg.search.wording import near

COLUMNS: Final = tuple(map(Column, ("rank", "score", "package", "node", "why", "also in", "file:line")))
Words = Annotated[list[str] | None, typer.Argument(metavar="TEXT", help="What the node does, in words.")]
FILTER_OPTIONS: Final = {
    one.name: Annotated[
        list[str] | None,
        typer.Option(f"--{one.name}", metavar=one.metavar, help=one.sentence, autocompletion=features(one.name)),
    ]
    for one in FILTERS.values()
    if one.name != "package"  # an option that other commands have too
}
Interactive = Annotated[bool, typer.Option("--interactive", "-i", help="Narrow the hits by questions.")]
Most = Annotated[str, typer.Option("--limit", "-n", metavar="N", help="Number of hits to show.")]


@with_options(FILTER_OPTIONS)
@with_settings("store")
def search(  # noqa: PLR0913 - the options of a command
    text: Words = None,
    *,
    settings: Settings,
    package: PackageName = None,
    limit: Most = "10",
    interactive: Interactive = False,
    json: Json = False,
    **given: list[str] | None,
) -> None:
    """Find nodes by what they do, with the reasons.

    The query may describe inputs and outputs (`turn a point cloud into a laser scan`) and contain filters: `subscribes
    PointCloud2 and publishes LaserScan`, `for ROS 2`, `BSD licensed`. Options are filters too. Each may be repeated,
    and all must match. For example:

        kg search "merge the scans of two lasers into one"
        kg search --subscribes LaserScan --publishes Odometry
        kg search "follow a person" --hardware lidar --ros 1 --json
        kg search "camera driver" -i
    """
    filters = {name: values for name, values in given.items() if values}
    if package:
        filters["package"] = [package]
    words = " ".join(text or ())
    if not words.strip() and not filters:
        hint = 'For example `kg search "merge two laser scans"`, or `kg search --publishes LaserScan`.'
        raise UsageError("KG003", "no search words or filters given", hint=hint)
    most = whole(limit, "--limit", 1)
    with _opened(settings) as index:
        if interactive:
            filters = narrow(index, words, filters)
        answer = index.find(words, filters, most)
    if words:
        report_reading(answer)
    if terminal() and not json:
        with reading(settings) as snapshot:
            links = Links.of(sources(snapshot))
        show_hits(answer.hits, links)
    else:
        listing(COLUMNS, [row(hit) for hit in answer.hits], objects=map(hit_object, answer.hits) if json else None)
    if len(answer.hits) < answer.total and (terminal() or json):
        note(f"the best {len(answer.hits)} of {count(answer.total, 'hit')}; --limit shows more")
    if not answer.hits:
        note(f"no results; {near(words, index) or 'try fewer words or filters'}")
        raise typer.Exit(Exit.FOUND)


@contextmanager
def _opened(settings: Settings) -> "Iterator[Search]":
    """Yield the search over the store in force; for a SPARQL server the index is built for this command alone."""
    if isinstance(settings.store, str):
        with reading_with_cache(settings) as (snapshot, cache):
            yield search_of(snapshot, cache)
    else:
        yield open_search(existing(settings), _indexing)


def _indexing() -> None:
    if sys.stderr.isatty():
        note("indexing the store (once after each change)")
