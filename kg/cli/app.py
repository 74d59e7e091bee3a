"""The commands of `kg`, in the order that `kg --help` lists them."""

from typing import Annotated, Any, Final

import typer

from kg.cli.commands import (
    build,
    channels,
    completions,
    compose,
    config,
    corpus,
    demo,
    diff,
    doctor,
    evaluate,
    evaluate_exercises,
    exchange,
    explain,
    extract,
    graph,
    impact,
    instances,
    lint,
    lists,
    mcp,
    node,
    nodes,
    ontology,
    param,
    query,
    robot,
    robot_driving,
    robot_programs,
    robot_simulate,
    rules,
    rules_check,
    rules_compile,
    rules_diff,
    rules_lsp,
    rules_reports,
    rules_run,
    rules_testing,
    rules_watch,
    search,
    serve,
    shell,
    stats,
    update,
    why,
)
from kg.cli.diagnostics import MODE, Mode
from kg.cli.group import KgCommand, KgGroup
from kg.cli.options import Store, from_setting
from kg.cli.output import json_lines, write
from kg.cli.session import Session
from kg.errors import Exit

__all__ = ["COMMANDS", "app"]

EPILOGUE: Final = """
Data goes to standard output, words go to standard error. Exit codes:

    0    it worked
    1    it worked and found something wrong, or did not find what was asked for
    2    the command or a setting is wrong
    3    a source could not be read at all
    4    the store is missing, busy, damaged or full
    5    a query was refused or failed
    6    a deadline or a limit ended the work
    70   a defect in kg
    130  interrupted

Start with `kg demo`, or with `kg build FOLDER` and then `kg search "what you need"`.
"""

COMMANDS: Final[tuple[tuple[str, str, Any], ...]] = (
    ("Start", "demo", demo.demo),
    ("Start", "build", build.build),
    ("Start", "status", build.status),
    ("Ask", "nodes", nodes.nodes),
    ("Ask", "node", node.node),
    ("Ask", "search", search.search),
    ("Ask", "compose", compose.compose),
    ("Ask", "instances", instances.instances),
    ("Ask", "graph", graph.graph),
    ("Ask", "diff", diff.diff),
    ("Ask", "impact", impact.impact),
    ("Ask", "query", query.query),
    ("Ask", "why", why.why),
    ("Ask", "why-not", why.why_not),
    ("Ask", "lint", lint.lint),
    ("Ask", "stats", stats.stats),
    ("Ask", "serve", serve.serve),
    ("Ask", "shell", shell.shell),
    ("Ask", "mcp", mcp.mcp),
    ("Ask", "packages", lists.packages),
    ("Ask", "topic", channels.topic),
    ("Ask", "service", channels.service),
    ("Ask", "action", channels.action),
    ("Ask", "param", param.param),
    ("Ask", "topics", lists.topics),
    ("Ask", "services", lists.services),
    ("Ask", "actions", lists.actions),
    ("Look after it", "export", exchange.export),
    ("Look after it", "import", exchange.import_files),
    ("Look after it", "update", update.update),
    ("Look after it", "forget", exchange.forget),
    ("Look after it", "backup", update.backup),
    ("Look after it", "restore", update.restore),
    ("Look after it", "completions", completions.completions),
    ("Look after it", "doctor", doctor.doctor),
    ("Look after it", "explain", explain.explain),
)

RULE_COMMANDS: Final[tuple[tuple[str, str, Any], ...]] = (
    ("Write", "new", rules.new),
    ("Write", "list", rules.list_rules),
    ("Write", "show", rules.show_rule),
    ("Write", "lsp", rules_lsp.lsp),
    ("Try", "check", rules_check.check),
    ("Try", "test", rules_testing.try_rules),
    ("Try", "diff", rules_diff.diff),
    ("Try", "watch", rules_watch.watch),
    ("Run", "run", rules_run.run),
    ("Look at", "compile", rules_compile.compile_rule),
    ("Look at", "graph", rules_reports.graph),
    ("Look at", "profile", rules_reports.profile),
    ("Look at", "coverage", rules_reports.coverage),
)
"""The commands of `kg rules`, in the order that its help lists them."""

ROBOT_COMMANDS: Final[tuple[tuple[str, str, Any], ...]] = (
    ("Look", "capabilities", robot.capabilities),
    ("Look", "watch", robot.watch),
    ("Drive", "read", robot_driving.read),
    ("Drive", "do", robot_driving.do),
    ("Program", "run", robot_programs.run),
    ("Program", "check", robot_programs.check),
    ("Program", "convert", robot_programs.convert),
    ("Try", "simulate", robot_simulate.simulate),
)
"""The commands of `kg robot`, in the order that its help lists them: the panel, the name and the function."""

CORPUS_COMMANDS: Final[tuple[tuple[str, Any], ...]] = (("select", corpus.select), ("fetch", corpus.fetch))
"""The commands of `kg corpus`, in the order that its help lists them."""

EVALUATIONS: Final[tuple[tuple[str, Any], ...]] = (
    ("completeness", evaluate.completeness),
    ("correctness", evaluate.correctness),
    ("sample", evaluate.sample),
    ("search", evaluate.search),
    ("exercises", evaluate_exercises.exercises),
)
"""The commands of `kg eval`, in the order that its help lists them."""

app = typer.Typer(
    cls=KgGroup,
    epilog=EPILOGUE,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version(value: bool) -> None:  # noqa: FBT001 - the signature of typer's callbacks
    if value:
        from importlib.metadata import version  # noqa: PLC0415 - start-up time

        write(f"kg {version('kg-ros')}")
        raise typer.Exit(Exit.OK)


def _speak_in(color: str | None) -> str | None:
    """Take --color before anything can go wrong; what is no colour is reported when the settings are read."""
    if color in {"always", "never"}:
        MODE.set(Mode(color, MODE.get().traceback))
    return color


Color = Annotated[str | None, from_setting("color", callback=_speak_in, is_eager=True)]
Version = Annotated[
    bool, typer.Option("--version", "-V", callback=_print_version, is_eager=True, help="Print the version and exit.")
]


def _print_description(context: typer.Context, value: bool) -> None:  # noqa: FBT001 - the signature of typer's callbacks
    if value:
        from kg.cli.reference import description  # noqa: PLC0415 - start-up time

        json_lines([description(context)])
        raise typer.Exit(Exit.OK)


Spec = Annotated[
    bool,
    typer.Option("--spec", callback=_print_description, is_eager=True, help="Describe all commands as JSON."),
]
Traceback = Annotated[
    bool, typer.Option("--traceback", help="Show errors with Python's traceback. [KG_DEBUG=1]", show_default=False)
]


@app.callback(invoke_without_command=True)
def kg(  # noqa: PLR0913 - the options before the command
    context: typer.Context,
    *,
    store: Store = None,
    color: Color = None,
    traceback: Traceback = False,
    version: Version = False,  # noqa: ARG001 - its callback does the work
    spec: Spec = False,  # noqa: ARG001 - its callback does the work
) -> None:
    """Know the ROS nodes of a workspace: what they publish, subscribe, offer and need, and on which line."""
    flags: dict[str, object] = {
        name: value for name, value in (("store", store), ("color", color)) if value is not None
    }
    context.obj = Session(flags)
    MODE.set(Mode(MODE.get().color, MODE.get().traceback or traceback))
    MODE.set(Mode(context.obj.settings().color, MODE.get().traceback))
    if context.invoked_subcommand is None:
        write(context.get_help())


config_app = typer.Typer(cls=KgGroup, rich_markup_mode=None)
config_app.callback(invoke_without_command=True)(config.config)
config_app.command("show", cls=KgCommand)(config.show)
for _panel, _name, _function in COMMANDS:
    _class = node.NodeCommand if _name == "node" else KgCommand
    app.command(_name, cls=_class, rich_help_panel=_panel)(_function)
rules_app = typer.Typer(cls=KgGroup, rich_markup_mode=None, help=rules.HELP)
for _panel, _name, _function in RULE_COMMANDS:
    rules_app.command(_name, cls=KgCommand, rich_help_panel=_panel)(_function)
app.add_typer(rules_app, name="rules", rich_help_panel="Ask")
robot_app = typer.Typer(cls=KgGroup, rich_markup_mode=None, help=robot.HELP)
for _panel, _name, _function in ROBOT_COMMANDS:
    robot_app.command(_name, cls=KgCommand, rich_help_panel=_panel)(_function)
app.add_typer(robot_app, name="robot", rich_help_panel="Ask")
corpus_app = typer.Typer(cls=KgGroup, rich_markup_mode=None, help=corpus.HELP)
for _name, _function in CORPUS_COMMANDS:
    corpus_app.command(_name, cls=KgCommand)(_function)
app.add_typer(corpus_app, name="corpus", rich_help_panel="Start")
eval_app = typer.Typer(cls=KgGroup, rich_markup_mode=None, help=evaluate.HELP)
for _name, _function in EVALUATIONS:
    eval_app.command(_name, cls=KgCommand)(_function)
app.add_typer(eval_app, name="eval", rich_help_panel="Ask")
ontology_app = typer.Typer(cls=KgGroup, rich_markup_mode=None, help="Check ontologies, and data against shapes.")
ontology_app.command("check", cls=KgCommand)(ontology.check)
ontology_app.command("validate", cls=KgCommand)(ontology.validate)
extract_app = typer.Typer(cls=KgGroup, rich_markup_mode=None, help="Check descriptions of framework calls.")
extract_app.command("check", cls=KgCommand)(extract.check)
app.add_typer(extract_app, name="extract", rich_help_panel="Look after it")
app.add_typer(ontology_app, name="ontology", rich_help_panel="Look after it")
app.add_typer(config_app, name="config", rich_help_panel="Look after it")
