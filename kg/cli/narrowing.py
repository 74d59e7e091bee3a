"""`kg search -i`: questions in the terminal, each answer of which adds a filter."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import click

from kg.render.text import count, printable
from kg.search.narrowing import Question, question

if TYPE_CHECKING:
    from kg.search.searching import Search

_LOOKED_AT: Final = 30  # number of best hits that questions split
_ENOUGH: Final = 2  # number of hits at which no more questions are asked


def narrow(index: Search, words: str, filters: dict[str, list[str]]) -> dict[str, list[str]]:
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


def _answer(current: Question, hits: int) -> str | None:
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
