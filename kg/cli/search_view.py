"""Search results for people and as rows, and the interpretation of the query."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.cli.diagnostics import note
from kg.cli.output import console, line_width, show
from kg.facts import Location
from kg.lazily import lazily
from kg.render.text import printable

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.cli.links import Links
    from kg.search.searching import Answer, Hit

with lazily():
    from rich.text import Text

    from kg.search.wording import understood, unknown

_REASONS: Final = 3
_MOST: Final = 4  # maximum number of copies and variants listed for a hit
_FIRST, _LATER, _NARROWEST = "   ", "     ", 24


def row(hit: Hit) -> tuple[object, ...]:
    """Return the cells of a hit: rank, score, package, node, why, also in, file:line."""
    why = "; ".join(str(reason) for reason in hit.why[:_REASONS])
    return hit.rank, f"{hit.score:.2f}", hit.package.name, hit.name, why, ", ".join(_others(hit)), _declared(hit)


def show_hits(hits: Iterable[Hit], links: Links) -> None:
    """Write hits for people: each with its reasons and the lines of code behind them, as links."""
    for hit in hits:
        if hit.rank > 1:
            show("")
        version = hit.node.ros or hit.package.ros
        about = ", ".join([hit.node.kind, *([f"ROS {version}"] if version else []), hit.package.repository])
        head = f"{hit.rank}. {hit.package.name}/{hit.name}"
        show(_line(Text.assemble((printable(head), "bold"), f"  {printable(about)}")))
        for text, place in _told(hit):
            address = links.to(hit.package.repository, place) if place else None
            style = f"green link {address}" if address else "green"
            show(*_folded(Text(printable(text)), Text(printable(str(place or "")), style=style)))


def _folded(words: Text, place: Text) -> list[Text]:
    """Return the lines of a reason, folded; places are never broken."""
    room = max(_NARROWEST, line_width() - len(_FIRST))
    parts = [words] if words.cell_len <= room else list(words.wrap(console(), room - 2))
    if place and parts[-1].cell_len + place.cell_len + 4 > room:
        parts.append(place)
    elif place:
        parts[-1] = Text.assemble(parts[-1], "  ", place)
    return [_line(Text.assemble(_FIRST if at == 0 else _LATER, part)) for at, part in enumerate(parts)]


def _told(hit: Hit) -> Iterator[tuple[str, Location | None]]:
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
        more = f" and {len(others) - _MOST} more" if len(others) > _MOST else ""
        yield f"also as {', '.join(others[:_MOST])}{more}", None


def _line(text: Text) -> Text:
    text.no_wrap, text.overflow = True, "ignore"
    return text


def _declared(hit: Hit) -> str:
    return f"{hit.node.path}:{hit.node.line}"


def _others(hit: Hit) -> list[str]:
    return list(
        dict.fromkeys(
            one.name if package.iri == hit.package.iri else f"{package.repository}:{package.name}/{one.name}"
            for package, one in hit.others
        )
    )


def tell(answer: Answer) -> None:
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
