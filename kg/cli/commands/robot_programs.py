"""`kg robot run`, `check` and `convert`: programs for robots."""

from typing import TYPE_CHECKING, Annotated

import typer

from kg.cli.diagnostics import note, report
from kg.cli.options import Exclusive, Json, is_given, with_settings
from kg.cli.output import json_lines, write
from kg.cli.systems import Arguments, Environment, Launch, given
from kg.errors import Exit, UsageError
from kg.lazily import lazily
from kg.settings import Settings

if TYPE_CHECKING:
    from kg.robot.capability import Capabilities
    from kg.robot.connection import ComputationGraph
    from kg.robot.programs.events import Ended
    from kg.robot.programs.places import Places as PlacesByName

with lazily():
    import asyncio

    from msgspec import to_builtins

    from kg.cli.interruptible import interruptible
    from kg.cli.numbers import seconds as number_of_seconds
    from kg.cli.program_view import Log, error_at, read, show_problems
    from kg.cli.robot_view import report_problems
    from kg.robot.connecting import address_of
    from kg.robot.live.asking import launched
    from kg.robot.live.asking import running as of_running
    from kg.robot.live.inference import general
    from kg.robot.programs.check import check as problems_of
    from kg.robot.programs.check import doubts
    from kg.robot.programs.converting import convert as code_of
    from kg.robot.programs.files import encode, load, load_tree
    from kg.robot.programs.metrics import code_metrics, foreign_types
    from kg.robot.programs.metrics import metrics as program_metrics
    from kg.robot.programs.places import placed, read_places
    from kg.robot.programs.runner import execute, limited, seen
    from kg.robot.programs.trees import behavior_tree
    from kg.robot.programs.write import write as text_of

_FORMS = ("text", "json", "rospy", "rclpy", "bt")
_TREE = ".xml"

Program = Annotated[
    str, typer.Argument(metavar="PROGRAM", help="Program as text (`.kgp`) or JSON (`.json`).", show_default=False)
]
DryRun = Annotated[bool, typer.Option("--dry-run", "-n", help="Print what would be sent, without moving the robot.")]
Seconds = Annotated[
    str | None,
    typer.Option("--seconds", metavar="S", help="Stop the program after this many seconds of the robot's time."),
]
To = Annotated[str, typer.Option("--to", metavar="FORM", help=f"One of {', '.join(_FORMS)}.", show_default=True)]
Ids = Annotated[bool, typer.Option("--ids", help="Keep the names of blocks in text, after `@`.")]
Metrics = Annotated[bool, typer.Option("--metrics", help="Write metrics of the program or the code instead.")]


@with_settings("robot", "places", "watchdog", "rules", "rule_families", "store")
def run(  # noqa: PLR0913 - the options of a command
    program: Program,
    *,
    settings: Settings,
    dry_run: DryRun = False,
    exclusive: Exclusive = False,
    seconds: Seconds = None,
    json: Json = False,
) -> None:
    """Run a program on a robot and print what happens.

    The program is checked first; if there are errors, it is not run. However it ends, the robot is stopped: on Ctrl-C,
    Ctrl-Z, an error, a timeout or a lost connection. If this process hangs or is killed, a watchdog stops the robot
    after --watchdog seconds. Exits with 1 if the program failed. For example:

        kg robot run mail.kgp
        kg robot run mail.kgp --dry-run
        kg robot run mail.kgp --robot ros1://turtle:11311 --seconds 60 --json
    """
    loaded = read(program, json=json)
    wanted = limited(loaded.program, None if seconds is None else number_of_seconds(seconds, "--seconds"))
    outcome: list[Ended | None] = []

    async def carry_out() -> None:
        result = await execute(
            wanted,
            address_of(settings),
            settings,
            on_event=Log(loaded, json=json),
            on_problems=lambda problems: show_problems(problems, loaded, json=json),
            dry_run=dry_run,
            exclusive=exclusive,
        )
        outcome.append(result)

    interruptible(carry_out(), moves=True)
    (ended,) = outcome
    if ended is not None and ended.problem is not None:
        report(error_at(ended.problem, loaded))
    if ended is None or ended.ended == "failed":
        raise typer.Exit(Exit.FOUND)


@with_settings("robot", "places", "rules", "rule_families", "store")
def check(  # noqa: PLR0913 - the options of a command
    program: Program,
    *,
    settings: Settings,
    launch: Launch = None,
    arg: Arguments = None,
    env: Environment = None,
    json: Json = False,
) -> None:
    """Check a program: names, kinds, units, limits, dead code, dead nodes.

    Without --robot and --launch, the program is checked against all capabilities of the ontology. Exits with 1 if
    there are errors; warnings do not count. For example:

        kg robot check mail.kgp
        kg robot check mail.kgp --robot ros1://turtle:11311
        kg robot check mail.kgp --launch rover.launch --places office.toml
    """
    loaded = read(program, json=json)
    capabilities, places, graph = _context(settings, launch, arg, env)
    bound = placed(loaded.program, places)
    problems = [*problems_of(bound, capabilities, places), *(doubts(bound, capabilities, graph) if graph else ())]
    show_problems(problems, loaded, json=json)
    if any(problem.severity == "error" for problem in problems):
        raise typer.Exit(Exit.FOUND)
    if not problems and not json:
        note(f"the program is sound for {capabilities.of}")


Convertible = Annotated[
    str,
    typer.Argument(
        metavar="PROGRAM",
        help="Program as text (`.kgp`) or JSON (`.json`), or a behaviour tree (`.xml`).",
        show_default=False,
    ),
]


@with_settings("robot", "places", "rules", "rule_families", "store")
def convert(  # noqa: PLR0913 - the options of a command
    program: Convertible,
    *,
    settings: Settings,
    to: To = "text",
    ids: Ids = False,
    metrics: Metrics = False,
    launch: Launch = None,
    arg: Arguments = None,
    env: Environment = None,
) -> None:
    """Convert a program to text, JSON, ROS code or a behaviour tree, or a tree to a program.

    The code is what an expert would write for the same task. It needs the robot's topics, services and actions: those
    of --robot or --launch, by default of the configured robot. Behaviour trees are those of BehaviorTree.CPP 4. For
    example:

        kg robot convert mail.kgp --to json > mail.json
        kg robot convert mail.kgp --to rospy --launch rover.launch > mail.py
        kg robot convert mail.kgp --to rclpy --metrics
        kg robot convert mail.kgp --to bt > mail.xml
        kg robot convert mail.xml > mail.kgp
    """
    if to not in _FORMS:
        raise UsageError("KG003", f"unknown form `{to}` of a program", hint=f"One of {', '.join(_FORMS)}.")
    loaded = load_tree(program, _context(settings, launch, arg, env)[0]) if program.endswith(_TREE) else load(program)
    if to in {"text", "json"}:
        if metrics:
            json_lines([to_builtins(program_metrics(loaded.program))])
        else:
            write((text_of(loaded.program, ids=ids) if to == "text" else encode(loaded.program).decode()).rstrip())
        return

    if to == "bt":
        capabilities, places, _ = _context(settings, launch, arg, env)
        write(behavior_tree(placed(loaded.program, places), capabilities, place=loaded.place).rstrip())
        return
    capabilities, places, _ = _context(settings, launch, arg, env, running=launch is None)
    code = code_of(
        placed(loaded.program, places), capabilities, to="rospy" if to == "rospy" else "rclpy", place=loaded.place
    )
    if metrics:
        json_lines([to_builtins(code_metrics(code))])
    else:
        write(code.rstrip())
    ros = 1 if to == "rospy" else 2
    for name in foreign_types(code, ros):
        note(f"ROS {ros} has no {name}: the robot that the code was made for speaks the other version")


def _context(
    settings: Settings, launch: str | None, arg: list[str] | None, env: list[str] | None, *, running: bool = False
) -> "tuple[Capabilities, PlacesByName, ComputationGraph | None]":
    """Return what a launch file, a running robot, or any by the ontology can do; places; the graph of what runs.

    A running robot is asked where the command line names one, or with `running`.
    """
    running = running or is_given(settings, "robot")
    own = read_places(settings.places)
    if launch is not None:
        if running:
            raise UsageError("KG003", "--launch conflicts with --robot", hint="Remove --robot.")
        with launched(settings, launch, *given(launch, arg, env)) as subject:
            return subject.capabilities, own, None
    if not running:
        return general(settings), own, None
    address = address_of(settings)
    graph, places = asyncio.run(seen(address))
    report_problems(graph)
    return of_running(graph, settings, address).capabilities, {**places, **own}, graph
