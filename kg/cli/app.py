"""The commands of `kg`, in the order that `kg --help` lists them."""

from typing import Annotated, Final

import typer

from kg.cli.diagnostics import MODE, Mode
from kg.cli.group import KgGroup, Later
from kg.cli.options import Store, from_setting
from kg.cli.output import json_lines, write
from kg.cli.session import Session
from kg.errors import Exit

__all__ = ["app"]

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

COMMANDS: Final = (
    Later(
        "Start",
        "demo",
        "demo:demo",
        "Build an example workspace, ask it five questions, prove what a rule inferred, and check its launch files.",
    ),
    Later("Start", "build", "build:build", "Read ROS packages into the store."),
    Later("Start", "status", "build:status", "List the sources in the store, and what has changed since."),
    Later("Ask", "nodes", "nodes:nodes", "List every node with how many interfaces it has."),
    Later("Ask", "node", "node:node", "Show one node: its interface, with lines of code.", "NodeCommand"),
    Later("Ask", "search", "search:search", "Find nodes by what they do, with the reasons."),
    Later("Ask", "compose", "compose:compose", "Find chains of nodes that turn one type of messages into another."),
    Later(
        "Ask",
        "instances",
        "instances:instances",
        "List every node that launch files start, with the name it has then.",
    ),
    Later("Ask", "graph", "graph:graph", "Show who talks to whom when a launch file is started."),
    Later("Ask", "diff", "diff:diff", "Show what changed in interfaces and wiring between two commits."),
    Later("Ask", "impact", "impact:impact", "Show what breaks if a name is renamed, removed or changed."),
    Later("Ask", "query", "query:query", "Ask in SPARQL, or by a stored query."),
    Later("Ask", "why", "why:why", "Show why a fact holds: the rules that derive it, down to the line of code."),
    Later("Ask", "why-not", "why:why_not", "Show why a fact does not hold: what each rule that could derive it lacks."),
    Later("Ask", "lint", "lint:lint", "Report what is wrong in the wiring of launch files."),
    Later("Ask", "stats", "stats:stats", "Count entities, triples, neighbours and paths of the graph."),
    Later("Ask", "serve", "serve:serve", "Serve the store: pages for people, a SPARQL endpoint for programs."),
    Later(
        "Ask",
        "shell",
        "shell:shell",
        "Ask and look around on the whole terminal: tree, queries, evidence, why, search, rules.",
    ),
    Later("Ask", "mcp", "mcp:mcp", "Serve coding assistants over the Model Context Protocol."),
    Later("Ask", "packages", "lists:packages", "List the packages with what was found in each."),
    Later(
        "Ask",
        "topic",
        "channels:topic",
        "Show who publishes and subscribes to a topic, in every launch file and in code.",
    ),
    Later(
        "Ask",
        "service",
        "channels:service",
        "Show who offers and calls a service, in every launch file and in code; as `kg topic`.",
    ),
    Later(
        "Ask",
        "action",
        "channels:action",
        "Show who offers and calls an action, in every launch file and in code; as `kg topic`.",
    ),
    Later(
        "Ask",
        "param",
        "param:param",
        "Show which nodes declare a parameter, and the value that it has in every launch file.",
    ),
    Later("Ask", "topics", "lists:topics", "List the topics, their types and how many nodes use them."),
    Later(
        "Ask",
        "services",
        "lists:services",
        "List the services, their types and how many nodes use them; `kg service NAME` shows one.",
    ),
    Later(
        "Ask",
        "actions",
        "lists:actions",
        "List the actions, their types and how many nodes use them; `kg action NAME` shows one.",
    ),
    Later("Look after it", "export", "exchange:export", "Write the graph as RDF."),
    Later("Look after it", "import", "exchange:import_files", "Add files of RDF to the store."),
    Later("Look after it", "update", "update:update", "Change the store in SPARQL."),
    Later("Look after it", "forget", "exchange:forget", "Take sources out of the store."),
    Later("Look after it", "backup", "update:backup", "Copy the store, also while it is written."),
    Later("Look after it", "restore", "update:restore", "Put a backup in the place of all that the store holds."),
    Later(
        "Look after it",
        "completions",
        "completions:completions",
        "Print what lets a shell complete commands, options, and names of the store.",
    ),
    Later("Look after it", "doctor", "doctor:doctor", "Check the installation and the store."),
    Later("Look after it", "explain", "explain:explain", "Say what an error code means."),
)
RULE_COMMANDS: Final = (
    Later("Write", "new", "rules:new", "Begin a rule: a file that runs as it stands, and examples that pass."),
    Later(
        "Write",
        "list",
        "rules:list_rules",
        "List the rules in force: those of kg, of installed packs, and your own.",
    ),
    Later(
        "Write",
        "show",
        "rules:show_rule",
        "Show one rule: its documentation, its text, what it reads and derives, and its place among the rules.",
    ),
    Later(
        "Write",
        "lsp",
        "rules_lsp:lsp",
        "Serve editors: errors as you type, completion, documentation, definitions.",
    ),
    Later("Try", "check", "rules_check:check", "Check rules: names, safety, strata, what never fires, documentation."),
    Later(
        "Try",
        "test",
        "rules_testing:try_rules",
        "Run the examples beside rules, and show what differs; exit code 1 when one fails.",
    ),
    Later(
        "Try",
        "diff",
        "rules_diff:diff",
        "Show what rules as they are on disk add to the store and take from it; exit code 1 when there is anything.",
    ),
    Later(
        "Try",
        "watch",
        "rules_watch:watch",
        "Check and test rules whenever they are saved, and show what they would change in the store.",
    ),
    Later("Run", "run", "rules_run:run", "Run the rules in force, and write what they infer into the store."),
    Later(
        "Look at",
        "compile",
        "rules_compile:compile_rule",
        "Print a rule as it is evaluated, or in another notation.",
    ),
    Later("Look at", "graph", "rules_reports:graph", "Draw which rules feed which, as SVG, Mermaid or JSON."),
    Later(
        "Look at",
        "profile",
        "rules_reports:profile",
        "Run the rules in memory and show what each costs: seconds, triples, rounds; the dearest first.",
    ),
    Later(
        "Look at",
        "coverage",
        "rules_reports:coverage",
        "Show which rules, and which parts of rules, never did anything on this store.",
    ),
)
ROBOT_COMMANDS: Final = (
    Later(
        "Look",
        "capabilities",
        "robot:capabilities",
        "List what a robot can sense, do and know, and through which topic, service or action.",
    ),
    Later(
        "Look",
        "watch",
        "robot:watch",
        "Keep a running robot in the store, in step with it, and say what came and went.",
    ),
    Later(
        "Drive",
        "read",
        "robot_driving:read",
        "Read what a robot senses or knows, a line for each value, until Ctrl-C.",
    ),
    Later("Drive", "do", "robot_driving:do", "Let a robot do something, and wait until it is done."),
    Later("Program", "run", "robot_programs:run", "Carry out a program on a robot, and write what happens."),
    Later(
        "Program",
        "check",
        "robot_programs:check",
        "Check a program: names, kinds and units, limits, what is never reached or never ends, nodes that are dead.",
    ),
    Later(
        "Program",
        "convert",
        "robot_programs:convert",
        "Write a program as text, as JSON, or as the code that an expert would write for it, in ROS 1 or ROS 2.",
    ),
    Later(
        "Try",
        "simulate",
        "robot_simulate:simulate",
        "Simulate a robot, which nodes of ROS speak for: a wheeled one in an office, or a drone over a field.",
    ),
)
CORPUS_COMMANDS: Final = (
    Later(
        "Commands",
        "select",
        "corpus:select",
        "Select projects from a table by criteria, and compare the selection with RNKG's.",
    ),
    Later(
        "Commands",
        "fetch",
        "corpus:fetch",
        "Fetch repositories, each at one commit, and pin the commits in a lock file.",
    ),
)
EVALUATIONS: Final = (
    Later(
        "Commands",
        "completeness",
        "evaluate:completeness",
        "Count what references name, or the code calls, and the graph knows.",
    ),
    Later(
        "Commands",
        "correctness",
        "evaluate:correctness",
        "Compare the relations of nodes with references: precision, recall and F1.",
    ),
    Later("Commands", "sample", "evaluate:sample", "Draw facts for a person to judge, or score such a sheet."),
    Later(
        "Commands",
        "search",
        "evaluate:search",
        "Compare the search with other ways to find nodes: NDCG@1 and NDCG@5.",
    ),
    Later(
        "Commands",
        "exercises",
        "evaluate_exercises:exercises",
        "Compare programs of capabilities with code that does the same, by four exercises for two simulated robots.",
    ),
)
ONTOLOGY_COMMANDS: Final = (
    Later(
        "Commands",
        "check",
        "ontology:check",
        "Reason over ontologies with HermiT (OWL 2 DL): each alone, then all together; exit code 1 for a "
        "contradiction.",
    ),
    Later(
        "Commands",
        "validate",
        "ontology:validate",
        "Hold the data of the store against SHACL shapes; exit code 1 when it does not conform.",
    ),
)
EXTRACT_COMMANDS: Final = (
    Later(
        "Commands",
        "check",
        "extract:check",
        "Check descriptions of framework calls: columns, types, argument numbers, rows that never match.",
    ),
)
CONFIG_COMMANDS: Final = (
    Later("Commands", "show", "config:show", "Show every setting with its value and where the value comes from."),
)


RULES: Final = """Write rules, try them and run them over the store.

A rule is a file in a folder of rules; its examples stand beside it. Folders of your own are those of the setting
`rules`, by default rules/ beside kg.toml or in the working folder. A new rule in five steps:

    kg rules new wiring/listens-to        writes a rule and its examples
    kg rules check wiring/listens-to      is it well written?
    kg rules test wiring/listens-to       does it do what its examples say?
    kg rules diff wiring/listens-to       what would it change in this store?
    kg rules run                          change it
"""
ROBOT: Final = """Say what a robot can do, and let it do so.

A robot is a running ROS system: its master, domain or router is given by --robot, else by the setting `robot`, else by
ROS_MASTER_URI or ROS_DOMAIN_ID. `kg robot simulate office` starts one to try.
"""


def _group(later: tuple[Later, ...]) -> type[KgGroup]:
    """Return the class of a group with some commands."""
    return type("Group", (KgGroup,), {"later": later})


app = typer.Typer(
    cls=_group(COMMANDS),
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


def _config(context: typer.Context) -> None:
    """Show settings and where they come from."""
    if context.invoked_subcommand is None:
        from kg.cli.commands.config import show  # noqa: PLC0415 - start-up time

        show(context)


for _name, _commands, _panel, _help in (
    ("rules", RULE_COMMANDS, "Ask", RULES),
    ("robot", ROBOT_COMMANDS, "Ask", ROBOT),
    ("corpus", CORPUS_COMMANDS, "Start", "Select repositories from a table of projects, and fetch them."),
    ("eval", EVALUATIONS, "Ask", "Measure the graph and the search against references and the code."),
    ("extract", EXTRACT_COMMANDS, "Look after it", "Check descriptions of framework calls."),
    ("ontology", ONTOLOGY_COMMANDS, "Look after it", "Check ontologies, and data against shapes."),
):
    _below = typer.Typer(cls=_group(_commands), rich_markup_mode=None, help=_help)
    app.add_typer(_below, name=_name, rich_help_panel=_panel)
_settings = typer.Typer(cls=_group(CONFIG_COMMANDS), rich_markup_mode=None)
_settings.callback(invoke_without_command=True)(_config)
app.add_typer(_settings, name="config", rich_help_panel="Look after it")
