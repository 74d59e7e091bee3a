"""`kg robot run`, `check` and `convert`: programs for robots."""

import json as as_json
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

from kg.cli.diagnostics import colored, dim, note, report
from kg.cli.options import Exclusive, Json, argument, is_given, option, with_settings
from kg.cli.options import seconds as number_of_seconds
from kg.cli.output import json_lines, json_value, write
from kg.cli.systems import Arguments, Environment, Launch, given
from kg.errors import Exit, Place, RobotError, UsageError
from kg.lazily import lazily
from kg.render.text import count, printable
from kg.settings import Settings

if TYPE_CHECKING:
    from kg.robot.capability import Capabilities
    from kg.robot.connection import ComputationGraph
    from kg.robot.programs.places import Places as PlacesByName


with lazily():
    import asyncio

    from msgspec import to_builtins

    from kg.cli.commands.robot import report_problems
    from kg.cli.interruptible import interruptible
    from kg.robot.connecting import address_of
    from kg.robot.live.asking import launched
    from kg.robot.live.asking import running as of_running
    from kg.robot.live.inference import general
    from kg.robot.programs.check import check as problems_of
    from kg.robot.programs.check import doubts
    from kg.robot.programs.converting import convert as code_of
    from kg.robot.programs.events import Ended, Problem
    from kg.robot.programs.files import Loaded, encode, load, load_tree
    from kg.robot.programs.metrics import code_metrics, foreign_types
    from kg.robot.programs.metrics import metrics as program_metrics
    from kg.robot.programs.places import placed, read_places
    from kg.robot.programs.runner import execute, limited, seen
    from kg.robot.programs.tree import statements
    from kg.robot.programs.trees import behavior_tree
    from kg.robot.programs.write import headline
    from kg.robot.programs.write import write as text_of


_FORMS = ("text", "json", "rospy", "rclpy", "bt")
_TREE = ".xml"

Program = Annotated[str, argument("PROGRAM", "Program as text (`.kgp`) or JSON (`.json`).", show_default=False)]
DryRun = Annotated[bool, option("--dry-run -n", "Print what would be sent, without moving the robot.")]
Seconds = Annotated[str | None, option("--seconds S", "Stop the program after this many seconds of the robot's time.")]
To = Annotated[str, option("--to FORM", f"One of {', '.join(_FORMS)}.", show_default=True)]
Ids = Annotated[bool, option("--ids", "Keep the names of blocks in text, after `@`.")]
Metrics = Annotated[bool, option("--metrics", "Write metrics of the program or the code instead.")]


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
    argument(
        "PROGRAM", "Program as text (`.kgp`) or JSON (`.json`), or a behaviour tree (`.xml`).", show_default=False
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


def read(path: str, *, json: bool) -> "Loaded":
    """Return the program in a file; with `json`, a syntax error is written like any other problem.

    Raises:
        typer.Exit: with `json`, the file is not a program.
        KGError: those of `load`.
    """
    try:
        return load(path)
    except RobotError as error:
        if not json:
            raise
        problem = Problem.of(error, "", None)
        json_lines([_problem_object(problem, path, error.place or Place(path))])
        raise typer.Exit(Exit.FOUND) from error


def error_at(problem: "Problem", loaded: "Loaded") -> RobotError:
    """Return a problem as an error at its place in the file."""
    return RobotError(problem.code, problem.message, place=loaded.place(problem.path), hint=problem.hint)


def show_problems(problems: "Sequence[Problem]", loaded: "Loaded", *, json: bool) -> None:
    """Write problems of a program: as text on standard error, or one object each on standard output."""
    if json:
        json_lines(_problem_object(problem, loaded.path, loaded.place(problem.path)) for problem in problems)
        return
    for problem in problems:
        report(error_at(problem, loaded), problem.severity)


def _problem_object(problem: "Problem", file: str, place: Place) -> dict[str, Any]:
    return {
        "severity": problem.severity,
        "code": problem.code,
        "message": problem.message,
        "hint": problem.hint,
        "id": problem.id,
        "path": problem.path,
        "file": file,
        "line": place.line,
        "column": place.column,
    }


class Log:
    """Writes the events of a program: lines with the time, or objects."""

    def __init__(self, loaded: "Loaded", *, json: bool) -> None:
        """Index the statements by their paths."""
        self._loaded = loaded
        self._json = json
        self._heads = {path: headline(one) for path, one in statements(loaded.program.body)}
        self._color = colored(sys.stdout)

    def __call__(self, event: dict[str, Any]) -> None:
        """Write an event."""
        if self._json:
            json_lines([json_value(event)])
        else:
            text = self._words(event)
            if text is not None:
                time = dim(f"{event['at']:9.3f} s", color=self._color)
                write(f"{time}  {printable(text)}")
        sys.stdout.flush()

    def _words(self, event: dict[str, Any]) -> str | None:
        path = event.get("path", "")
        match event["event"]:
            case "enter":
                line = self._loaded.place(path).line
                return f"{line or path}: {self._heads[path]}"
            case "value":
                value = event["value"] if not isinstance(event["value"], float) else f"{event['value']:.4g}"
                return f"  {event['parameter']} of {event['capability']} = {value} {event.get('unit', '')}".rstrip()
            case "set":
                return f"  {event['variable']} = {event['shown']}"
            case "log":
                return f"  {event['message']}"
            case "warning":
                return f"  warning[{event['code']}]: {event['message']}"
            case "event":
                return f"  it happened: {self._heads[path]}"
            case "planned":
                value = as_json.dumps(json_value(event["value"]))
                return f"  would send to {event['kind']} {event['name']} ({event['type']}): {value}"
            case "paused" | "resumed":
                return str(event["event"])
            case "done" | "stopped" | "failed" | "cancelled":
                return f"{event['event']} after {count(event['statements'], 'statement')}"
        return None
