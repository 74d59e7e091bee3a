"""An impact as lines for people, as Markdown for a pull request, and as plain values for JSON."""

from __future__ import annotations

from dataclasses import replace
from itertools import groupby
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from kg.impact.model import Area, Effect, Grade, Impact
from kg.launch.comparison.report import code
from kg.render.text import count, printable

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from kg.facts import Location
    from kg.impact.changes import Broken

Link: TypeAlias = "Callable[[str, Location], str | None]"
"""Gives the address of a line of a source."""
_ROWS: Final = 200
"""So many rows has a table at most."""
_SYSTEMS: Final = 2
"""So many launch files are named; of more, their number."""


def summary(impact: Impact) -> str:
    """Return how much breaks and may break, in one sentence."""
    certain, possible = impact.count(Grade.BREAKS), impact.count(Grade.MAY)
    if not impact.effects:
        return "nothing is known to use it"
    return f"{count(certain, 'place')} break{'s' if certain == 1 else ''}, {count(possible, 'place')} may"


def impact_lines(impact: Impact) -> list[str]:
    """Return lines for people: the subject, then the effects by area."""
    about = f" ({', '.join(impact.about)})" if impact.about else ""
    lines = [printable(f"{impact.subject.kind} {impact.subject.text}{about}"), summary(impact), ""]
    for area, effects in _areas(impact):
        lines += [str(area), *_effect_lines(effects), ""]
    return lines[:-1]


def _effect_lines(effects: Sequence[Effect]) -> Iterator[str]:
    for _, group in groupby(effects, key=_written_once):
        one, *others = group
        where = f"  {one.location}" if one.location else ""
        yield printable(f"  {one.grade:<6}  {one.what}{where}")
        launches = tuple(sorted({name for each in (one, *others) for name in each.systems}))
        more = f"; the same for {count(len(others), 'more node')}" if others else ""
        yield printable(f"          {_reason(replace(one, reason=one.reason + more, systems=launches))}")


def _written_once(one: Effect) -> object:
    """Return a key that is equal for the effects of one line of a file on several nodes."""
    if one.location is None or one.area not in {Area.LAUNCH, Area.PARAMETERS}:
        return id(one)
    return one.area, one.grade, one.location, one.repository, one.reason


def _reason(one: Effect) -> str:
    return "; ".join(filter(None, [one.reason, _systems(one)]))


def _systems(one: Effect) -> str:
    if not one.systems:
        return ""
    more = len(one.systems) - _SYSTEMS
    others = f" and {count(more, 'more launch file')}" if more > 0 else ""
    return f"in {', '.join(one.systems[:_SYSTEMS])}{others}"


def impact_markdown(impact: Impact, link: Link | None = None) -> str:
    """Return Markdown: the numbers, then a table for each area."""
    parts = [f"### {impact.subject.kind} {code(impact.subject.text)}", "", f"**{summary(impact)}**", ""]
    for area, effects in _areas(impact):
        parts += _table(str(area), effects, link)
    return "\n".join(parts)


def _table(title: str, effects: Sequence[Effect], link: Link | None = None) -> list[str]:
    rows, more = [_row(one, link) for one in effects[:_ROWS]], len(effects) - _ROWS
    left_out = [f"{count(more, 'more row')} left out.", ""] if more > 0 else []
    return [f"#### {title}", "", "|   | what | why | where |", "|---|---|---|---|", *rows, "", *left_out]


def _row(one: Effect, link: Link | None) -> str:
    where = ""
    if one.location is not None:
        address = link(one.repository, one.location) if link else None
        where = f"[{code(str(one.location))}]({address})" if address else code(str(one.location))
    return f"| {one.grade} | {code(one.what)} | {code(_reason(one))} | {where} |"


def impact_object(impact: Impact) -> dict[str, Any]:
    """Return an impact as plain values, ready for JSON; the fields of docs/formats.md."""
    return {
        "kind": str(impact.subject.kind),
        "name": impact.subject.name,
        "owner": impact.subject.owner or None,
        "about": list(impact.about),
        "breaks": impact.count(Grade.BREAKS),
        "may": impact.count(Grade.MAY),
        "effects": [_effect_object(one) for one in impact.effects],
    }


def _effect_object(one: Effect) -> dict[str, Any]:
    return {
        "grade": str(one.grade),
        "area": str(one.area),
        "what": one.what,
        "reason": one.reason,
        **_where(one),
        "systems": list(one.systems),
        "started": {"file": one.started.path, "line": one.started.line} if one.started else None,
    }


def _where(one: Effect | Broken) -> dict[str, Any]:
    path, line = (one.location.path, one.location.line or None) if one.location else (None, None)
    return {"file": path, "line": line, "repository": one.repository or None}


def _areas(impact: Impact) -> Iterator[tuple[str, list[Effect]]]:
    for area, effects in groupby(impact.effects, key=lambda one: one.area):
        yield area, list(effects)


def broken_summary(changes: Sequence[Broken]) -> str:
    """Return how many changes break something elsewhere, in one sentence."""
    if not changes:
        return "no differences"
    certain = sum(one.count(Grade.BREAKS) > 0 for one in changes)
    possible = sum(bool(one.effects) for one in changes) - certain
    verb = "breaks" if certain == 1 else "break"
    return f"{count(len(changes), 'change')}: {certain} {verb} something elsewhere, {possible} may"


def broken_lines(changes: Sequence[Broken]) -> list[str]:
    """Return lines for people: each change that breaks something, with what it breaks."""
    lines = []
    for one in changes:
        if one.effects:
            where = f"  {one.location}" if one.location else ""
            lines += [printable(f"{one.words}{where}"), *_effect_lines(one.effects), ""]
    return [*lines, broken_summary(changes)]


def broken_markdown(changes: Sequence[Broken], title: str) -> str:
    """Return Markdown: the numbers, then a table for each change that breaks something."""
    parts = [f"### {code(title)}", "", f"**{broken_summary(changes)}**", ""]
    for one in changes:
        if one.effects:
            parts += _table(code(one.words), one.effects)
    return "\n".join(parts)


def broken_objects(changes: Sequence[Broken]) -> Iterator[dict[str, Any]]:
    """Yield each change as plain values, ready for JSON; the fields of docs/formats.md."""
    for one in changes:
        yield {
            "change": one.words,
            **_where(one),
            "breaks": one.count(Grade.BREAKS),
            "may": one.count(Grade.MAY),
            "effects": [_effect_object(each) for each in one.effects],
        }
