"""The commands of `kg`, in the order that `kg --help` lists them."""

from typing import Annotated, Final

import typer

from kg.cli.diagnostics import MODE, Mode
from kg.cli.group import KgGroup, Later, Panels
from kg.cli.options import Session, Store, from_setting, option
from kg.cli.output import json_lines, write
from kg.errors import Exit
from kg.lazily import lazily

with lazily():
    from importlib.metadata import version

    from kg.cli.commands.doctor import show_settings
    from kg.cli.manual import description

EPILOGUE: Final = """
Data goes to standard output, messages go to standard error. Exit codes:

    0    success
    1    success, but problems were found or nothing matched
    2    invalid command or setting
    3    a source could not be read at all
    4    the store is missing, busy, damaged or full
    5    a query was refused or failed
    6    a deadline or limit was reached
    70   internal error in kg
    130  interrupted

Start with `kg demo`, or with `kg build FOLDER` and then `kg search "what you need"`.
"""

COMMANDS: Final[Panels] = {
    "Start": {
        "demo": ("demo:demo", "Try kg on an example workspace: build, ask, prove and lint."),
        "build": ("build:build", "Read ROS packages into the store."),
        "status": ("build:status", "List the sources in the store and what has changed since the build."),
    },
    "Ask": {
        "nodes": ("lists:nodes", "List all nodes with the number of their interfaces."),
        "node": ("node:node", "Show the interface of one node, with lines of code.", "NodeCommand"),
        "search": ("search:search", "Find nodes by what they do, with the reasons."),
        "compose": ("compose:compose", "Find chains of nodes that convert one message type into another."),
        "instances": ("graph:instances", "List the nodes that launch files start, with their run-time names."),
        "graph": ("graph:graph", "Show the nodes and connections that a launch file starts."),
        "diff": ("diff:diff", "Show changes in interfaces and wiring between two commits."),
        "impact": ("diff:impact", "Show what breaks if a name is renamed, removed or changed."),
        "query": ("query:query", "Run a SPARQL query or a stored query."),
        "why": ("why:why", "Prove a fact: show the rules that derive it, down to the source line."),
        "why-not": ("why:why_not", "Show why a fact is missing: what each rule that could derive it lacks."),
        "lint": ("lint:lint", "Report problems in the wiring of launch files."),
        "stats": ("stats:stats", "Count entities, triples, neighbours and paths of the graph."),
        "serve": ("serve:serve", "Serve the store as web pages and a SPARQL endpoint."),
        "shell": ("serve:shell", "Explore the store in a full-screen terminal interface."),
        "mcp": ("serve:mcp", "Serve coding assistants over the Model Context Protocol."),
        "packages": ("lists:packages", "List the packages with their nodes, interfaces and problems."),
        "files": ("lists:files", "List the files of packages, sorted into code and text."),
        "topic": ("channels:topic", "Show a topic's publishers and subscribers, by launch file and in code."),
        "service": ("channels:service", "Show a service's servers and clients; works like `kg topic`."),
        "action": ("channels:action", "Show an action's servers and clients; works like `kg topic`."),
        "param": ("channels:param", "Show the nodes that declare a parameter, and its value per launch file."),
        "topics": ("lists:topics", "List the topics with their types and numbers of nodes."),
        "services": ("lists:services", "List the services with their types and numbers of nodes."),
        "actions": ("lists:actions", "List the actions with their types and numbers of nodes."),
    },
    "Maintain": {
        "export": ("exchange:export", "Write the graph as RDF, or as a table of quads."),
        "import": ("exchange:import_files", "Add RDF files to the store."),
        "update": ("update:update", "Change the store with SPARQL Update."),
        "forget": ("exchange:forget", "Remove sources from the store."),
        "backup": ("update:backup", "Copy the store, even while it is being written."),
        "publish": ("exchange:publish", "Write the graph for others, to a folder or a web server."),
        "pull": ("exchange:pull", "Fetch a published graph and make a store of it."),
        "restore": ("update:restore", "Replace the contents of the store with a backup."),
        "completions": ("doctor:completions", "Print a shell completion script for commands, options and names."),
        "doctor": ("doctor:doctor", "Check the installation and the store."),
        "explain": ("doctor:explain", "Explain an error code and how to fix the error."),
    },
}
RULE_COMMANDS: Final[Panels] = {
    "Write": {
        "new": ("rules:new", "Create a rule that runs as it is, with examples that pass."),
        "list": ("rules:list_rules", "List the active rules: those of kg, of installed packs, and your own."),
        "show": ("rules:show_rule", "Show one rule: documentation, text, inputs, results and dependencies."),
        "lsp": ("rules:lsp", "Serve editors: rules as you type them, and the findings of `kg lint`."),
    },
    "Try": {
        "check": ("rules_check:check", "Check rules: names, safety, strata, dead rules, documentation."),
        "test": ("rules_check:try_rules", "Run the examples of rules and show what differs."),
        "diff": ("rules:diff", "Show what the rules on disk would add to and remove from the store."),
        "watch": ("rules_check:watch", "Check and test rules on every save, and show their effect on the store."),
    },
    "Run": {"run": ("rules_run:run", "Run the active rules and write what they infer into the store.")},
    "Inspect": {
        "compile": ("rules:compile_rule", "Print a rule as it is evaluated, or in another notation."),
        "plan": ("rules_run:plan", "Show which rules can run on each source alone, and why not."),
        "graph": ("rules_run:graph", "Draw which rules feed which, as SVG, Mermaid or JSON."),
        "profile": ("rules_run:profile", "Run the rules in memory and show their cost, most expensive first."),
        "coverage": ("rules_run:coverage", "Show the rules, and parts of rules, that never matched in this store."),
    },
}
ROBOT_COMMANDS: Final[Panels] = {
    "Look": {
        "capabilities": (
            "robot:capabilities",
            "List a robot's capabilities and the topics, services or actions they use.",
        ),
        "topics": ("robot_topics:topics", "List a robot's topics with types, publishers and subscribers."),
        "nodes": ("robot_topics:nodes", "List a robot's nodes with the states of managed ones."),
        "params": ("robot_topics:params", "Show the parameters of running nodes, or set one."),
        "watch": ("robot:watch", "Mirror a running robot in the store, and report what changes."),
        "record": ("robot_topics:record", "Record topics of a robot to a file, until Ctrl-C."),
    },
    "Drive": {
        "read": ("robot_driving:read", "Print values sensed or stored by a robot, one per line, until Ctrl-C."),
        "do": ("robot_driving:do", "Run a capability of a robot and wait until it is done."),
    },
    "Program": {
        "run": ("robot_programs:run", "Run a program on a robot and print what happens."),
        "check": ("robot_programs:check", "Check a program: names, kinds, units, limits, dead code, dead nodes."),
        "convert": (
            "robot_programs:convert",
            "Convert a program to text, JSON, ROS code or a behaviour tree, or a tree to a program.",
        ),
    },
    "Try": {
        "simulate": (
            "robot_simulate:simulate",
            "Simulate a robot with ROS nodes: on wheels in an office, a drone, or an arm.",
        )
    },
}
CORPUS_COMMANDS: Final[Panels] = {
    "Commands": {
        "select": ("corpus:select", "Select projects from a table by criteria, and compare with RNKG's."),
        "fetch": ("corpus:fetch", "Fetch repositories, each at one commit, and pin the commits in a lock file."),
    }
}
EVALUATIONS: Final[Panels] = {
    "Commands": {
        "completeness": ("evaluate:completeness", "Measure how much of references or code the graph contains."),
        "correctness": (
            "evaluate:correctness",
            "Compare the relations of nodes with references: precision, recall and F1.",
        ),
        "sample": ("evaluate:sample", "Draw facts to be judged by a person, or score a judged sheet."),
        "search": ("evaluate:search", "Compare the search with other methods: NDCG@1 and NDCG@5."),
        "exercises": ("evaluate:exercises", "Compare capability programs with equivalent code in four exercises."),
        "study": (
            "evaluate:study",
            "Evaluate the results of a study: time, attempts, blocks and capabilities of each exercise.",
        ),
    }
}
ONTOLOGY_COMMANDS: Final[Panels] = {
    "Commands": {
        "check": ("ontology:check", "Check ontologies with the reasoner HermiT (OWL 2 DL)."),
        "classify": ("ontology:classify", "Print what follows from ontologies by OWL 2 DL, as Turtle."),
        "validate": ("ontology:validate", "Validate the data of the store against SHACL shapes."),
    }
}
EXTRACT_COMMANDS: Final[Panels] = {
    "Commands": {
        "check": ("extract:check", "Check descriptions of framework calls: columns, types, arguments, matches.")
    }
}
CONFIG_COMMANDS: Final[Panels] = {
    "Commands": {"show": ("doctor:show_settings", "Show all settings with their values and origins.")}
}


RULES: Final = """Write, test and run rules.

A rule is a file in a folder of rules, with its examples in the same folder. The setting `rules` lists your own folders:
by default rules/ next to kg.toml or in the working folder. A new rule in five steps:

    kg rules new wiring/listens-to        create a rule and its examples
    kg rules check wiring/listens-to      check how it is written
    kg rules test wiring/listens-to       run its examples
    kg rules diff wiring/listens-to       preview its effect on this store
    kg rules run                          apply it
"""
ROBOT: Final = """List, use and program the capabilities of a robot.

A robot is a running ROS system, or a recording of one. Its master, domain, router or file is given by --robot, the
setting `robot`, or ROS_MASTER_URI or ROS_DOMAIN_ID, in this order. `kg robot simulate office` starts a simulated one.
"""


def _group(panels: Panels) -> type[KgGroup]:
    later = [Later(panel, name, *rest) for panel, entries in panels.items() for name, rest in entries.items()]
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
        write(f"kg {version('kg-ros')}")
        raise typer.Exit(Exit.OK)


def _speak_in(color: str | None) -> str | None:
    """Apply --color before anything can fail; an invalid value is reported when the settings are read."""
    if color in {"always", "never"}:
        MODE.set(Mode(color, MODE.get().traceback))
    return color


Color = Annotated[str | None, from_setting("color", callback=_speak_in, is_eager=True)]
Version = Annotated[bool, option("--version -V", "Print the version and exit.", callback=_print_version, is_eager=True)]


def _print_description(context: typer.Context, value: bool) -> None:  # noqa: FBT001 - the signature of typer's callbacks
    if value:
        json_lines([description(context)])
        raise typer.Exit(Exit.OK)


Spec = Annotated[bool, option("--spec", "Describe all commands as JSON.", callback=_print_description, is_eager=True)]
Traceback = Annotated[bool, option("--traceback", "Show Python tracebacks of errors. [KG_DEBUG=1]", show_default=False)]


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
    """Index and search the ROS nodes of a workspace, with the line behind each fact."""
    flags: dict[str, object] = {
        name: value for name, value in (("store", store), ("color", color)) if value is not None
    }
    context.obj = Session(flags)
    MODE.set(Mode(MODE.get().color, MODE.get().traceback or traceback))
    MODE.set(Mode(context.obj.settings().color, MODE.get().traceback))
    if context.invoked_subcommand is None:
        write(context.get_help())


for _name, _commands, _panel, _help in (
    ("rules", RULE_COMMANDS, "Ask", RULES),
    ("robot", ROBOT_COMMANDS, "Ask", ROBOT),
    ("corpus", CORPUS_COMMANDS, "Start", "Select repositories from a table of projects and fetch them."),
    ("eval", EVALUATIONS, "Ask", "Measure the graph and the search against references and the code."),
    ("extract", EXTRACT_COMMANDS, "Maintain", "Check descriptions of framework calls."),
    ("ontology", ONTOLOGY_COMMANDS, "Maintain", "Check and classify ontologies, and validate data."),
):
    _below = typer.Typer(cls=_group(_commands), rich_markup_mode=None, help=_help)
    app.add_typer(_below, name=_name, rich_help_panel=_panel)
_settings = typer.Typer(cls=_group(CONFIG_COMMANDS), rich_markup_mode=None)
app.add_typer(_settings, name="config", rich_help_panel="Maintain")


@_settings.callback(invoke_without_command=True)
def _config(context: typer.Context) -> None:
    """Show settings and their origins."""
    if context.invoked_subcommand is None:
        show_settings(context)
