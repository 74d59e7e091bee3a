"""What the pictures share: text that cannot leave its place in SVG, labels, and lines with rounded corners."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache
from html import escape
from pathlib import Path
from typing import Final

from kg.render.text import printable

_STYLES: Final = Path(__file__).parent / "styles"
_TIP: Final = 7.0
"""How far before its target a line ends, where its head begins."""
_ROUND: Final = 7.0
_LONGEST: Final = 38


def document(style: str, size: tuple[int, int], title: str, words: str, drawn: Iterable[str]) -> str:
    """Return a picture of this size in pixels, described by `title` and `words`; `style` names a file in `styles`."""
    wide, high = size
    attributes = f'width="{wide}" height="{high}" viewBox="0 0 {wide} {high}" role="img" aria-labelledby="title desc"'
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" {attributes}>',
        f'<title id="title">{escaped(title)}</title>',
        f'<desc id="desc">{escaped(words)}</desc>',
        f"<style>\n{stylesheet(style)}</style>",
        *drawn,
        "</svg>",
        "",
    ]
    return "\n".join(lines)


@cache
def stylesheet(name: str) -> str:
    """Return the style of a kind of picture, for light and dark."""
    return (_STYLES / f"{name}.css").read_text("utf-8").rstrip("\n")


def short(text: str, longest: int = _LONGEST) -> str:
    """Return `text` with its middle cut if it is long; the full text is in the title of its group."""
    safe = printable(text)
    half = longest // 2
    return safe if len(safe) <= longest else f"{safe[: half - 1]}…{safe[-half:]}"


def escaped(text: str) -> str:
    """Return `text` escaped for XML, without control characters."""
    return escape(printable(text), quote=True)


def label(  # noqa: PLR0913, PLR0917 - what a text element has
    style: str, x: float, y: float, text: str, anchor: str = "start", longest: int = _LONGEST
) -> str:
    """Return a line of text at `x` on the base line `y`, shortened where it is long."""
    return f'<text class="{style}" x="{x:g}" y="{y:g}" text-anchor="{anchor}">{escaped(short(text, longest))}</text>'


def before_tip(points: Sequence[tuple[float, float]]) -> Sequence[tuple[float, float]]:
    """Return the corners of a line that ends where its head begins; of level and upright pieces."""
    (ax, ay), (bx, by) = points[-2:]
    far = abs(bx - ax) + abs(by - ay)
    if far <= _TIP:
        return points
    return [*points[:-1], (bx - (bx - ax) * _TIP / far, by - (by - ay) * _TIP / far)]


def rounded(points: Sequence[tuple[float, float]]) -> str:
    """Return the path of a line with round corners."""
    path = f"M{points[0][0]:g} {points[0][1]:g}"
    for (ax, ay), (bx, by), (cx, cy) in zip(points, points[1:], points[2:], strict=False):
        before, after = abs(bx - ax) + abs(by - ay), abs(cx - bx) + abs(cy - by)
        if not before or not after:
            continue
        start, end = min(_ROUND, before / 2) / before, min(_ROUND, after / 2) / after
        path += f"L{bx + (ax - bx) * start:g} {by + (ay - by) * start:g}"
        path += f"Q{bx:g} {by:g} {bx + (cx - bx) * end:g} {by + (cy - by) * end:g}"
    return f"{path}L{points[-1][0]:g} {points[-1][1]:g}"


def arrow(points: Sequence[tuple[float, float]]) -> str:
    """Return the path of the head of a line, in the direction of its last piece."""
    x, y = points[-1]
    across, down = _direction(points)
    if abs(across) >= abs(down):
        return f"M{x:g} {y:g}l{-8 if across > 0 else 8} -4.5v9z"
    return f"M{x:g} {y:g}l-4.5 {-8 if down > 0 else 8}h9z"


def bar(points: Sequence[tuple[float, float]]) -> str:
    """Return the path of a bar across the end of a line."""
    x, y = points[-1]
    across, down = _direction(points)
    if abs(across) >= abs(down):
        return f"M{x - 3 if across > 0 else x + 3:g} {y - 7:g}v14"
    return f"M{x - 7:g} {y - 3 if down > 0 else y + 3:g}h14"


def _direction(points: Sequence[tuple[float, float]]) -> tuple[float, float]:
    x, y = points[-1]
    back = next((one for one in reversed(points[:-1]) if one != points[-1]), (x - 1, y))
    return x - back[0], y - back[1]
