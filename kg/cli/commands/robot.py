"""`kg robot`: what a robot can do, and the store in step with it."""

from contextlib import ExitStack
from typing import TYPE_CHECKING, Annotated

import typer

from kg.cli.completion import packages
from kg.cli.options import Json, is_given, with_settings
from kg.cli.systems import Arguments, Environment, Launch, given
from kg.errors import Exit, UsageError
from kg.lazily import lazily
from kg.settings import Settings

if TYPE_CHECKING:
    from kg.robot.live.asking import Subject

with lazily():
    import asyncio

    from kg.cli.robot_view import follow, report_problems, show_added, show_capabilities, show_proofs
    from kg.robot.connecting import address_of, look
    from kg.robot.live import Watching
    from kg.robot.live.asking import launched, of_package, running
    from kg.store.opening import writable

Live = Annotated[bool, typer.Option("--live", help="Use the running robot (the default).")]
Package = Annotated[
    str | None,
    typer.Option(
        "--package",
        "-p",
        metavar="NAME",
        help="A package of the store; with --live or --launch, what it would add to them.",
        autocompletion=packages,
    ),
]
Why = Annotated[str | None, typer.Option("--why", metavar="CAPABILITY", help="Explain a capability, for each node.")]
All = Annotated[bool, typer.Option("--all", "-a", help="Include general capabilities that others imply.")]
Name = Annotated[
    str | None,
    typer.Option("--name", metavar="NAME", help="Name of the system in the store; by default its address."),
]
Once = Annotated[bool, typer.Option("--once", help="Store the current state of the system and exit.")]


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
def watch(
    *,
    settings: Settings,
    name: Name = None,
    once: Once = False,
    json: Json = False,
) -> None:
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
