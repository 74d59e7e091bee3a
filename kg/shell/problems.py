"""What the store says is wrong in a buffer while it is written."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

from kg.query.statements import statements
from kg.shell.editor import Problem

if TYPE_CHECKING:
    from kg.shell.link import Link


async def diagnosed(link: Link, text: str) -> list[Problem]:
    """Return the problems of each query in a buffer; KgError when the store cannot be asked."""
    found = []
    starts = [one.start for one in statements(text)]
    for begin, end in pairwise([*starts, len(text)]):
        answer = await link.call("diagnose", text=text[begin:end].rstrip())
        found += [_problem(one, begin) for one in answer["problems"]]
    return found


def _problem(found: dict[str, Any], begin: int) -> Problem:
    words = ". ".join(str(found[key]).rstrip(".") for key in ("message", "hint") if found.get(key))
    fix = next(iter(found["fixes"]), None)
    edits = tuple((begin + one["start"], begin + one["end"], one["text"]) for one in fix["edits"]) if fix else ()
    place = (begin + found["start"], begin + found["end"])
    return Problem(*place, found["severity"], words, fix["title"] if fix else "", edits)
