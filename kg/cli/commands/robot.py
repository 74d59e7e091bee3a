"""`kg robot capabilities` and `kg robot watch`: what a robot can do, and the store in step with it."""

import sys
from contextlib import ExitStack
from typing import TYPE_CHECKING, Annotated, Final

import typer

from kg.cli.completion import packages
from kg.cli.diagnostics import note, problem
from kg.cli.options import Json, is_given, option, with_settings
from kg.cli.output import Column, json_lines, listing, terminal, write
from kg.cli.systems import Arguments, Environment, Launch, given
from kg.errors import Exit, UsageError
from kg.lazily import lazily
from kg.render.text import count, printable
from kg.settings import Settings

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.robot.capability import Capabilities, Capability
    from kg.robot.connection import ComputationGraph


with lazily():
    import asyncio

    import msgspec

    from kg.cli.commands.why import print_tree
    from kg.graph.source_states import sources
    from kg.robot.capabilities import added
    from kg.robot.connecting import address_of, look
    from kg.robot.live import Event, Watching
    from kg.robot.live.asking import Subject, launched, of_package, running
    from kg.rules.explain.text import proof_lines, proof_object
    from kg.store.opening import writable
    from kg.views.evidence import Places


Live = Annotated[bool, option("--live", "Use the running robot (the default).")]
Package = Annotated[
    str | None,
    option(
        "--package -p NAME",
        "A package of the store; with --live or --launch, what it would add to them.",
        autocompletion=packages,
    ),
]
Why = Annotated[str | None, option("--why CAPABILITY", "Explain a capability, for each node.")]
All = Annotated[bool, option("--all -a", "Include general capabilities that others imply.")]
Name = Annotated[str | None, option("--name NAME", "Name of the system in the store; by default its address.")]
Once = Annotated[bool, option("--once", "Store the current state of the system and exit.")]


@with_settings("robot", "rules", "rule_families", "store")
def capabilities(  # noqa: PLR0913 - the options of a command
    *,
    settings: Settings,
    launch: Launch = None,
    live: Live = False,
    package: Package = None,
    why: Why = None,
    every: All = False,
    arg: Arguments = None,
    env: Environment = None,
    json: Json = False,
) -> None:
    """List a robot's capabilities and the topics, services or actions they use.

    For a running robot, kg reads the computation graph and infers the capabilities by rules; no store is needed. For a
    launch file or package of the store, nothing needs to run. Capabilities are read (data from the robot) or written
    (commands to the robot). For example:

        kg robot capabilities
        kg robot capabilities --launch rover.launch
        kg robot capabilities --package turtle_tf --launch rover.launch
        kg robot capabilities --why drivingAtVelocity
    """
    live = live or is_given(settings, "robot")
    if launch is not None and live:
        raise UsageError("KG003", "--launch conflicts with --live and --robot", hint="Remove --live and --robot.")
    with ExitStack() as stack:
        base = None
        if launch is not None:
            base = stack.enter_context(launched(settings, launch, *given(launch, arg, env)))
        elif live or package is None:
            base = _running(settings)
        subject = stack.enter_context(of_package(settings, package)) if package is not None else base
        if subject is None:
            return
        if why is not None:
            show_proofs(subject, why, json=json)
        elif subject is not base and base is not None:
            show_added(subject.capabilities, base.capabilities, every=every, json=json)
        else:
            show_capabilities(subject.capabilities, every=every, json=json)


def _running(settings: Settings) -> "Subject":
    address = address_of(settings)
    graph = asyncio.run(look(address))
    report_problems(graph)
    return running(graph, settings, address)


@with_settings("robot", "rules", "rule_families", "store")
def watch(*, settings: Settings, name: Name = None, once: Once = False, json: Json = False) -> None:
    """Mirror a running robot in the store, and report what changes.

    Nodes that start or stop, and their capabilities, are updated in the store within a second, in a separate graph.
    The store is created if it is missing. `kg instances`, `kg lint`, `kg graph`, `kg why` and the page work on it as
    on a launch file. If the connection is lost, kg waits for the robot. Press Ctrl-C to stop; the graph keeps the last
    state. For example:

        kg robot watch
        kg robot watch --robot ros1://turtle:11311 --name turtle
        kg robot watch --once && kg lint --launch robot/localhost:11311
    """
    try:
        with writable(settings) as target:
            watching = Watching(target, settings, address=address_of(settings), name=name or "")
            asyncio.run(follow(watching, once=once, json=json))
    except KeyboardInterrupt:
        raise typer.Exit(Exit.INTERRUPTED) from None


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


def report_problems(graph: "ComputationGraph") -> None:
    """Warn of problems of peers, such as dead nodes: their capabilities are missing from the table."""
    for one in graph.problems:
        problem(one.code, one.message, one.subject)


def show_capabilities(listed: "Capabilities", *, every: bool, json: bool, none: str = "") -> None:
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
    # As in docs/robots.md: every key is present.
    objects = (
        {name: msgspec.to_builtins(getattr(one, name)) for name in one.__struct_fields__} for one in listed.capabilities
    )
    listing(columns, rows, objects=objects if json else None)
    if json:
        return
    hidden = len(listed.capabilities) - len(chosen)
    if not listed.capabilities:
        note(none or f"{listed.of} has no capability of the ontology")
    elif hidden and terminal():
        note(f"{count(len(chosen), 'capability', 'capabilities')}, and {hidden} implied ones; --all lists all")


def show_added(subject: "Capabilities", base: "Capabilities", *, every: bool, json: bool) -> None:
    """Write the capabilities that a package would add."""
    gained = added(subject, base)
    if not json and gained.capabilities:
        note(f"what {subject.of} would add to {base.of}")
    none = f"{subject.of} would add nothing to {base.of}" if subject.capabilities else ""
    show_capabilities(gained, every=every, json=json, none=none)


def show_proofs(subject: "Subject", name: str, *, json: bool) -> None:
    """Write the proof of a capability for each node: trees, or one object each."""
    proofs = subject.why(name)
    if json:
        json_lines(proof_object(proof, subject.view) for proof in proofs)
        return

    for proof in proofs:
        print_tree(proof_lines(proof, subject.view), Places.of(sources(subject.graph)))


async def follow(watching: "Watching", *, once: bool, json: bool) -> None:
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


def _write_event(event: "Event", *, json: bool) -> None:
    if json:
        json_lines([msgspec.to_builtins(event)])
    else:
        _say(event)
    sys.stdout.flush()


def _say(event: "Event") -> None:
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


def _parameters(one: "Capability") -> "Iterator[str]":
    """Yield the parameters with a field in some interface of the robot, with their units."""
    for parameter in one.parameters:
        if not one.ways or any(parameter.name in way.fields for way in one.ways):
            yield f"{parameter.name} {parameter.unit}" if parameter.unit else parameter.name


def _ways(one: "Capability") -> "Iterator[str]":
    if not one.ways:
        yield f"follows from {', '.join(one.implied_by)}"
    shown = _SHOWN if terminal() else len(one.ways)
    for way in one.ways[:shown]:
        yield f"{way.name} of {way.node}"
    if len(one.ways) > shown:
        yield f"{len(one.ways) - shown} more"
