"""`kg serve`, `kg shell` and `kg mcp`: the interfaces that run until they are ended."""

import os
import sys
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from typing import Annotated, Any
from urllib.parse import quote

import typer

from kg.cli.completion import queries as query_names
from kg.cli.diagnostics import note
from kg.cli.options import Store, option, session, takes, with_settings
from kg.errors import Exit, UsageError
from kg.lazily import lazily
from kg.server.options import DECLARED
from kg.settings import DECLARED as OF_SETTINGS
from kg.settings import Settings

with lazily():
    import webbrowser

    from kg.cli.commands.query import query
    from kg.server.libraries import libraries
    from kg.server.options import Options
    from kg.server.running import serve as run
    from kg.server.safety.tokens import Tokens
    from kg.settings import load_table
    from kg.shell.running import run as run_shell
    from kg.store.opening import layout_of, or_empty


Open = Annotated[bool, option("--open", "Open the start page in the browser.")]


@takes(DECLARED.values())
@with_settings("watchdog", "store")
def serve(*, settings: Settings, open_page: Open = False, **given: Any) -> None:
    """Serve the store as web pages and a SPARQL endpoint.

    By default, the server listens on this machine only and is read-only. It follows builds: each request is answered
    from the newest data. With --robot it needs no store. Press Ctrl-C to stop it. For example:

        kg serve
        kg serve --port 0 --open
        KG_TOKEN=... kg serve --write
        KG_TOKEN=... kg serve --robot ros1://localhost:11311
        curl --data-urlencode 'query=SELECT * {?s ?p ?o} LIMIT 3' http://127.0.0.1:7878/sparql
    """
    chosen = options(given)
    # A robot can be used without a store; changes are refused without one, for they would be lost.
    with or_empty(settings) if chosen.robot and not chosen.write else nullcontext(settings) as served:
        if served is not settings:
            note("no store found, serving an empty one; `kg build` creates one")
        run(served, chosen, lambda address: announce(address, served, chosen, say=note, browse=open_page))


def options(given: "Mapping[str, object]") -> "Options":
    """Return the options of a server: flags by field name, then variables and `kg.toml`; the token is `$KG_TOKEN`.

    Raises UsageError KG002 for an invalid value.
    """
    from kg.server.options import DECLARED  # noqa: PLC0415 - start-up time

    return Options(token=os.environ.get("KG_TOKEN") or None, **load_table(DECLARED, given))


def announce(
    address: str, settings: Settings, options: "Options", *, say: "Callable[[str], None]", browse: bool
) -> None:
    """Report the address, the data and the access rules of the server; with `browse` open its start page."""
    from kg.server.libraries import HELP  # noqa: PLC0415 - start-up time

    data = "unnamed graph" if options.no_union else "union of all graphs"
    say(f"serving {layout_of(settings).name} at {address}")
    say(f"SPARQL at {address}sparql (default graph: {data}), graphs at {address}store")
    say("changes: from clients with the token" if options.write else "changes: none; `--write` allows them")
    if options.robot:
        who = (
            "read only"
            if options.robot.startswith("bag:")
            else "moved by clients with the token"
            if options.token or options.token_file
            else "moving it is not allowed; set KG_TOKEN to allow it"
        )
        say(f"robot {options.robot} at {address}robot ({who})")
    token = Tokens(options.token, options.token_file).current
    if token and sys.stderr.isatty():  # where this is written to a file, the token stays out of it
        say(f"log in: {address}login#token={quote(token, safe='')}")
    if not libraries():
        say(f"pages have no pictures and a plain editor: their libraries are not installed. {HELP}")
    if browse:
        webbrowser.open(address)


Once = Annotated[
    str | None,
    option(
        "--once QUERY",
        "Answer QUERY (SPARQL, or the name of a stored query) like `kg query` and exit.",
        autocompletion=query_names,
    ),
]


@takes(OF_SETTINGS[one] for one in ("format", "limit", "timeout", "queries"))
def shell(context: typer.Context, *, once: Once = None, store: Store = None, **given: Any) -> None:
    """Explore the store in a full-screen terminal interface.

    It has a tree of the store, queries, evidence, proofs, search and rules. F1 shows all keys, Ctrl+P runs any action
    by name, Ctrl+Q quits. Buffers and history are kept between runs. For example:

        kg shell
        kg --store demo shell
        kg shell --once 'SELECT ?node { ?node a rnkg:NodeType }' --format csv
    """
    if once is not None:
        query(context, once, store=[store] if store else None, **given)
        return

    code = run_shell(session(context).settings(store=store, **given))
    if code != Exit.OK:
        raise typer.Exit(code)


@with_settings("timeout", "robot", "store")
def mcp(*, settings: Settings) -> None:
    """Serve coding assistants over the Model Context Protocol.

    An assistant starts the server and talks to it on standard input and output. It can find and describe nodes, show
    how launch files wire them, what a change breaks or changed, report findings, run read-only queries and explain
    facts, each with lines of code. It can read the robot, check programs for it, and run them if a person agrees.
    Needs `pip install 'kg-ros[mcp]'`. For example, in an assistant's settings:

        {"mcpServers": {"kg": {"command": "kg", "args": ["--store", "/path/to/.kg", "mcp"]}}}
    """
    try:
        from kg.assistants.server import serve  # noqa: PLC0415 - start-up time
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] != "mcp":
            raise
        hint = "pip install 'kg-ros[mcp]'"
        raise UsageError("KG555", "the SDK of the Model Context Protocol is not installed", hint=hint) from error
    serve(settings)
