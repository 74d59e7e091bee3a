"""`kg serve`: the SPARQL endpoint and the pages."""

import os
import sys
from contextlib import nullcontext
from typing import TYPE_CHECKING, Annotated, Any
from urllib.parse import quote

import typer

from kg.cli.diagnostics import note
from kg.cli.options import takes, with_settings
from kg.lazily import lazily
from kg.server.options import DECLARED
from kg.settings import Settings

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


with lazily():
    import webbrowser

    from kg.server.libraries import libraries
    from kg.server.options import Options
    from kg.server.running import serve as run
    from kg.server.safety.tokens import Tokens
    from kg.settings import load_table
    from kg.store.opening import layout_of, or_empty


Open = Annotated[bool, typer.Option("--open", help="Open the start page in the browser.")]


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
