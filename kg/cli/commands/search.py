"""`kg search`: nodes by what they do, need and are wired to, with the reasons."""

import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Annotated, Final

import typer

from kg.cli.completion import features
from kg.cli.diagnostics import note
from kg.cli.options import Json, PackageName, argument, option, whole, with_options, with_settings
from kg.cli.output import Column, folded, listing, show, terminal, unfolded
from kg.errors import Exit, UsageError
from kg.facts import Location
from kg.lazily import lazily
from kg.render.text import count, printable, some
from kg.search.options import FILTERS
from kg.settings import Settings
from kg.store.opening import existing, reading, reading_with_cache

with lazily():
    import click
    from rich.text import Text

    from kg.cli.links import Links
    from kg.graph.source_states import sources
    from kg.search.searching import Answer, Hit, Search, hit_object, open_search, search_of
    from kg.search.wording import Question, advice, question, understood, unknown


COLUMNS: Final = tuple(map(Column, ("rank", "score", "package", "node", "why", "also in", "file:line")))
Words = Annotated[list[str] | None, argument("TEXT", "What the node does, in words.")]
FILTER_OPTIONS: Final = {
    one.name: Annotated[
        list[str] | None, option(f"--{one.name} {one.metavar}", one.sentence, autocompletion=features(one.name))
    ]
    for one in FILTERS.values()
    if one.name != "package"  # an option that other commands have too
}
Interactive = Annotated[bool, option("--interactive -i", "Narrow the hits by questions.")]
Most = Annotated[str, option("--limit -n N", "Number of hits to show.")]


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
        note(f"no results. {advice(answer.need, index)}")
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


_REASONS: Final = 3
_MOST: Final = 4  # maximum number of copies and variants listed for a hit


def row(hit: "Hit") -> tuple[object, ...]:
    """Return the cells of a hit: rank, score, package, node, why, also in, file:line."""
    why = "; ".join(str(reason) for reason in hit.why[:_REASONS])
    declared = f"{hit.node.path}:{hit.node.line}"
    return hit.rank, f"{hit.score:.2f}", hit.package.name, hit.node.name, why, ", ".join(_others(hit)), declared


def show_hits(hits: "Iterable[Hit]", links: "Links") -> None:
    """Write hits for people: each with its reasons and the lines of code behind them, as links."""
    for hit in hits:
        if hit.rank > 1:
            show("")
        version = hit.node.ros or hit.package.ros
        about = ", ".join([hit.node.kind, *([f"ROS {version}"] if version else []), hit.package.repository])
        head = f"{hit.rank}. {hit.package.name}/{hit.node.name}"
        show(unfolded(Text.assemble((printable(head), "bold"), f"  {printable(about)}")))
        for text, place in _statements(hit):
            address = links.to(hit.package.repository, place) if place else None
            style = f"green link {address}" if address else "green"
            where = Text(printable(str(place)), style=style) if place else None
            show(*folded(Text(printable(text)), where, Text(" " * 3), Text(" " * 5)))


def _statements(hit: "Hit") -> "Iterator[tuple[str, Location | None]]":
    """Yield the statements about a hit, each with its place; at least its declaration."""
    places = []
    for reason in hit.why[:_REASONS]:
        places.append(None if reason.path is None else Location(reason.path, reason.line or 0))
        yield reason.text, places[-1]
    declared = Location(hit.node.path, hit.node.line or 0)
    if declared not in places:
        yield "declared", declared
    others = _others(hit)
    if others:
        yield f"also as {some(others, _MOST)}", None


def _others(hit: "Hit") -> list[str]:
    return list(
        dict.fromkeys(
            one.name if package.iri == hit.package.iri else f"{package.repository}:{package.name}/{one.name}"
            for package, one in hit.others
        )
    )


def report_reading(answer: "Answer") -> None:
    """Report on standard error how the words were read, which ones describe no node, and whether anything fits."""
    from kg.search.wording import NEAREST  # noqa: PLC0415 - start-up time

    strict, rather = understood(answer.need)
    if strict:
        note(f"only nodes with: {', '.join(strict)}")
    if rather:
        note(f"preferring nodes with: {', '.join(rather)}")
    for sentence in unknown(answer.need):
        note(sentence)
    if answer.hits and not answer.fits:
        note(NEAREST)


_LOOKED_AT: Final = 30  # number of best hits that questions split
_ENOUGH: Final = 2  # number of hits at which no more questions are asked


def narrow(index: "Search", words: str, filters: dict[str, list[str]]) -> dict[str, list[str]]:
    """Ask questions that split the hits until few are left, and return the filters with the answers added.

    An empty line skips a question; `q` or the end of the input stops.
    """
    chosen, skipped = dict(filters), set[str]()
    while True:
        hits = index.find(words, chosen, _LOOKED_AT).hits
        current = question(hits, {**chosen, **dict.fromkeys(skipped)}) if len(hits) > _ENOUGH else None
        if current is None:
            return chosen
        answer = _answer(current, len(hits))
        if answer is None:
            return chosen
        if answer:
            chosen[current.kind] = [answer]
        else:
            skipped.add(current.kind)


def _answer(current: "Question", hits: int) -> str | None:
    """Return the chosen value, an empty text for none of them, None to stop."""
    click.echo(f"{current.text} ({count(hits, 'hit')})", err=True)
    for number, (value, left) in enumerate(current.answers, 1):
        click.echo(f"  {number}. {printable(value)} ({left})", err=True)
    while True:
        try:
            typed = click.prompt("Number, Enter to skip, q to stop", default="", show_default=False, err=True).strip()
        except click.Abort:
            return None
        if typed.lower() == "q":
            return None
        if not typed:
            return ""
        if typed.isdigit() and 0 < int(typed) <= len(current.answers):
            return current.answers[int(typed) - 1][0]
        click.echo(f"`{printable(typed)}` is not a number from 1 to {len(current.answers)}", err=True)
