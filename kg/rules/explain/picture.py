"""Proofs as an SVG picture: each fact on top, its premises below it indented, each with its line of code."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final
from xml.sax.saxutils import escape

from kg.render.svg import stylesheet
from kg.rules.explain.text import Line, proof_lines

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.rules.explain.proof import Proof
    from kg.rules.explain.view import View

_ROW: Final = 22
_CHAR: Final = 7.9
_STEP: Final = 22
_MARGIN: Final = 16


def picture(proofs: Sequence[Proof], view: View) -> str:
    """Return proofs, one below the other, as one SVG; text only, the same for the same proofs."""
    lines = [line for proof in proofs for line in proof_lines(proof, view)]
    texts = (f"{line.text}  {line.where}" if line.where else line.text for line in lines)
    width = max(_MARGIN * 2 + _left(line) + len(text) * _CHAR for line, text in zip(lines, texts, strict=True))
    height = _MARGIN * 2 + len(lines) * _ROW
    body = "\n".join([*_guides(lines), *(_text(line, row) for row, line in enumerate(lines))])
    title = escape(lines[0].text)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height}" width="{width:.0f}" '
        f'height="{height}" role="img" aria-label="Proof of {escape(title, {chr(34): "&quot;"})}">\n'
        f"<title>{title}</title>\n<style>\n{stylesheet('proof')}\n</style>\n{body}\n</svg>\n"
    )


def _depth(line: Line) -> int:
    """Return how many branches are before a line: each is three signs wide, the last of a rule's line two."""
    return (len(line.branches) + 1) // 3


def _left(line: Line) -> float:
    return _depth(line) * _STEP


def _baseline(row: int) -> float:
    return _MARGIN + row * _ROW + 15


def _text(line: Line, row: int) -> str:
    place = f'<tspan class="place" dx="14">{escape(line.where)}</tspan>' if line.where else ""
    left = _MARGIN + _left(line)
    return f'<text class="{line.kind}" x="{left:g}" y="{_baseline(row):g}">{escape(line.text)}{place}</text>'


def _guides(lines: Sequence[Line]) -> Iterator[str]:
    """Yield the lines of the tree: from each fact down its premises."""
    for row, line in enumerate(lines):
        if line.kind != "fact" or not line.branches:
            continue
        depth = _depth(line)
        above = next((index for index in range(row - 1, -1, -1) if _depth(lines[index]) < depth), 0)
        x = _MARGIN + depth * _STEP - _STEP / 2
        y = _baseline(row) - 5
        yield f'<line x1="{x:g}" y1="{_baseline(above) + 4:g}" x2="{x:g}" y2="{y:g}"/>'
        yield f'<line x1="{x:g}" y1="{y:g}" x2="{x + _STEP / 2 - 3:g}" y2="{y:g}"/>'
