"""Capabilities of robots for people and programs, and the events of `kg robot watch`."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any, Final

import msgspec

from kg.cli.diagnostics import note, problem
from kg.cli.output import Column, json_lines, listing, terminal, write
from kg.lazily import lazily
from kg.render.text import count, printable

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.robot.capability import Capabilities, Capability
    from kg.robot.connection import ComputationGraph
    from kg.robot.live import Event, Watching
    from kg.robot.live.asking import Subject

with lazily():
    from kg.cli.trees import print_tree
    from kg.graph.source_states import sources
    from kg.robot.capabilities import added
    from kg.rules.explain.export import proof_object
    from kg.rules.explain.text import proof_lines
    from kg.views.evidence import Places

_COLUMNS: Final = (
    Column("kind", spare=3),
    Column("capability", "name"),
    Column("what", spare=2),
    Column("way"),
    Column("parameters", spare=1),
    Column("through", "dim", spare=4),
)
_UNAVAILABLE: Final = Column("unavailable")
_SHOWN: Final = 2  # maximum number of interfaces of a capability listed in a table on a terminal
_SIGN: Final = {"came": "+", "went": "-"}


def report_problems(graph: ComputationGraph) -> None:
    """Warn of problems of peers, such as dead nodes: their capabilities are missing from the table."""
    for one in graph.problems:
        problem(one.code, one.message, one.subject)


def show_capabilities(listed: Capabilities, *, every: bool, json: bool, none: str = "") -> None:
    """Write capabilities: a table by kind of those with interfaces, and general ones too with `every`.

    `none` is the text for an empty list.
    """
    chosen = [one for one in listed.capabilities if every or one.ways]
    columns = (*_COLUMNS, _UNAVAILABLE) if any(one.unavailable for one in chosen) else _COLUMNS
    rows = [
        (
            one.kinds[0] if one.kinds else "",
            one.name,
            one.label,
            one.modality,
            ", ".join(_parameters(one)),
            "; ".join(_ways(one)),
            one.unavailable or "",
        )[: len(columns)]
        for one in chosen
    ]
    listing(columns, rows, objects=map(capability_object, listed.capabilities) if json else None)
    if json:
        return
    hidden = len(listed.capabilities) - len(chosen)
    if not listed.capabilities:
        note(none or f"{listed.of} has no capability of the ontology")
    elif hidden and terminal():
        note(f"{count(len(chosen), 'capability', 'capabilities')}, and {hidden} implied ones; --all lists all")


def show_added(subject: Capabilities, base: Capabilities, *, every: bool, json: bool) -> None:
    """Write the capabilities that a package would add."""
    gained = added(subject, base)
    if not json and gained.capabilities:
        note(f"what {subject.of} would add to {base.of}")
    none = f"{subject.of} would add nothing to {base.of}" if subject.capabilities else ""
    show_capabilities(gained, every=every, json=json, none=none)


def show_proofs(subject: Subject, name: str, *, json: bool) -> None:
    """Write the proof of a capability for each node: trees, or one object each."""
    proofs = subject.why(name)
    if json:
        json_lines(proof_object(proof, subject.view) for proof in proofs)
        return

    for proof in proofs:
        print_tree(proof_lines(proof, subject.view), Places.of(sources(subject.graph)))


def capability_object(one: Capability) -> dict[str, Any]:
    """Return a capability as a plain object, documented in docs/robots.md; every key is present."""
    fields: dict[str, Any] = {name: msgspec.to_builtins(getattr(one, name)) for name in one.__struct_fields__}
    return fields


async def follow(watching: Watching, *, once: bool, json: bool) -> None:
    """Write the events of a robot, with `once` its current state; finally mark the graph as ended."""
    try:
        if once:
            for event in await watching.once():
                _write_event(event, json=json)
        else:
            async for event in watching.events():
                _write_event(event, json=json)
    finally:
        await watching.end()


def _write_event(event: Event, *, json: bool) -> None:
    if json:
        json_lines([msgspec.to_builtins(event)])
    else:
        _say(event)
    sys.stdout.flush()


def _say(event: Event) -> None:
    """Write additions and removals as lines, all others as notes."""
    if event.change is not None:
        kind = {"end": " ", "node": "", "capability": "can "}[event.event]
        detail = f"  {event.detail}" if event.detail else ""
        write(printable(f"{_SIGN[event.change]} {kind}{event.name}{detail}"))
        return
    words = {
        "watching": f"watching {event.detail} as robot/{event.name}; Ctrl-C ends",
        "back": f"{event.name} is back",
        "state": f"{event.name} is {event.detail}",
        "lost": f"{event.name} is lost: {event.detail}; waiting for it",
        "busy": f"{event.detail}; waiting for it",
        "problem": f"{event.name}: {event.detail}",
        "kept": f"generation {event.generation}, in {event.seconds} s",
    }
    note(words[event.event])


def _parameters(one: Capability) -> Iterator[str]:
    """Yield the parameters with a field in some interface of the robot, with their units."""
    for parameter in one.parameters:
        if not one.ways or any(parameter.name in way.fields for way in one.ways):
            yield f"{parameter.name} {parameter.unit}" if parameter.unit else parameter.name


def _ways(one: Capability) -> Iterator[str]:
    if not one.ways:
        yield f"follows from {', '.join(one.implied_by)}"
    shown = _SHOWN if terminal() else len(one.ways)
    for way in one.ways[:shown]:
        yield f"{way.name} of {way.node}"
    if len(one.ways) > shown:
        yield f"{len(one.ways) - shown} more"
