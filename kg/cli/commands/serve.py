"""`kg serve`: the SPARQL endpoint and the pages."""

from contextlib import nullcontext
from typing import Annotated, Any

import typer

from kg.cli.diagnostics import note
from kg.cli.options import Store, WatchdogSeconds, takes
from kg.cli.session import session
from kg.server.options import DECLARED

Open = Annotated[bool, typer.Option("--open", help="Open the start page in the browser.")]


@takes(DECLARED.values())
def serve(
    context: typer.Context,
    *,
    watchdog: WatchdogSeconds = None,
    open_page: Open = False,
    store: Store = None,
    **given: Any,
) -> None:
    """Serve the store as web pages and a SPARQL endpoint.

    By default, the server listens on this machine only and is read-only. It follows builds: each request is answered
    from the newest data. With --robot it needs no store. Press Ctrl-C to stop it. For example:

        kg serve
        kg serve --port 0 --open
        KG_TOKEN=... kg serve --write
        KG_TOKEN=... kg serve --robot ros1://localhost:11311
        curl --data-urlencode 'query=SELECT * {?s ?p ?o} LIMIT 3' http://127.0.0.1:7878/sparql
    """
    from kg.cli.serving import announce, options  # noqa: PLC0415 - start-up time
    from kg.server.running import serve as run  # noqa: PLC0415 - start-up time
    from kg.store.opening import or_empty  # noqa: PLC0415 - start-up time

    chosen = options(given)
    settings = session(context).settings(store=store, watchdog=watchdog)
    # A robot can be used without a store; changes are refused without one, for they would be lost.
    with or_empty(settings) if chosen.robot and not chosen.write else nullcontext(settings) as served:
        if served is not settings:
            note("no store found, serving an empty one; `kg build` creates one")
        run(served, chosen, lambda address: announce(address, served, chosen, say=note, browse=open_page))
