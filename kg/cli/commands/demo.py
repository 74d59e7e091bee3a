"""`kg demo`: the example workspace, built, asked five questions, one inferred fact proven, a launch file checked."""

import sys
from contextlib import ExitStack, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from kg.cli.diagnostics import colored, say
from kg.cli.options import option, session
from kg.cli.output import write
from kg.errors import UsageError
from kg.lazily import lazily
from kg.render.text import count
from kg.resources import folder

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

with lazily():
    from tempfile import TemporaryDirectory

    from kg.cli.commands.lint import lint
    from kg.cli.commands.query import table
    from kg.cli.commands.why import why
    from kg.cli.links import Links
    from kg.graph.source_states import sources
    from kg.pipeline.build import build
    from kg.query.core import ask
    from kg.query.result import Solutions
    from kg.query.stored import find
    from kg.store.embedded import EmbeddedStore

QUESTIONS: Final = (
    "demo/laser-scans",
    "demo/who-talks-to-whom",
    "demo/called-services",
    "demo/named-by-parameters",
    "demo/made-at-run-time",
)
FACT: Final = ("scan_filter", "rnkg:usesHardware", "laserScanner")
"""What rules inferred and the demo proves."""
_END: Final = """
{begin}
    kg --store {store} nodes
    kg --store {store} node flight_controller
    kg --store {store} graph --launch mission.launch.xml
    kg --store {store} query --list

To read your own sources:

    kg build ~/catkin_ws/src"""
_TEMPORARY: Final = "The demo store is temporary. To keep one and explore it:\n\n    kg demo --store demo"

Keep = Annotated[str | None, option("--store -s FOLDER", "Keep the store in FOLDER; by default it is temporary.")]


def demo(context: typer.Context, *, store: Keep = None) -> None:
    """Try kg on an example workspace: build, ask, prove and lint.

    The workspace contains a ROS 1 rover and a ROS 2 drone. The demo needs no robot, no ROS and no network.
    """
    chosen = store or session(context).flags.get("store")
    settings = session(context).settings(store=chosen)
    workspace = folder("examples") / "workspace"
    if not workspace.is_dir():
        raise UsageError("KG003", f"missing example workspace: {workspace}", hint="Install kg again.")
    with ExitStack() as stack:
        root = Path(str(chosen)) if chosen else Path(stack.enter_context(TemporaryDirectory(prefix="kg-demo-"))) / ".kg"
        target = EmbeddedStore.create(root)
        say(f"reading {workspace}")
        report = build([str(workspace)], target, settings, command="kg demo")
        counts = [count(report.total(key), noun) for key, noun in (("nodes", "node"), ("interfaces", "interface"))]
        outcome = f"found {' with '.join(counts)} in {count(report.total('packages'), 'package')}"
        say(f"{outcome}, in {report.seconds:.1f} s")
        bold = ("\x1b[1m", "\x1b[0m") if colored(sys.stdout) else ("", "")
        with target.read() as snapshot:
            _ask_all(snapshot, settings, bold)
        settings = replace(settings, store=target.layout.root)
        title = "How is it known that scan_filter works with a laser scanner?"
        write(f"\n{bold[0]}{len(QUESTIONS) + 1}. {title}{bold[1]}\n")
        write(f"    kg why {' '.join(FACT)}\n")
        why(list(FACT), settings=settings)
        write(f"\n{bold[0]}{len(QUESTIONS) + 2}. What is wrong in the launch files?{bold[1]}\n")
        write("    kg lint\n")
        with suppress(typer.Exit):
            lint(settings=settings)
    begin = f"The store is in {chosen}. To explore it:\n" if chosen else _TEMPORARY
    write(_END.format(begin=begin, store=chosen or "demo"))


def _ask_all(snapshot: "EmbeddedSnapshot", settings: "Settings", bold: tuple[str, str]) -> None:
    links = Links.of(sources(snapshot))
    for number, name in enumerate(QUESTIONS, 1):
        query = find(name)
        write(f"\n{bold[0]}{number}. {query.title}{bold[1]}\n")
        for line in query.text.splitlines():
            if line and not line.startswith("#"):
                write(f"    {line}")
        write()
        result = ask(snapshot, query, {}, timeout=settings.timeout or None)
        if isinstance(result, Solutions):
            table(result, links)
