"""`kg serve`: the SPARQL endpoint and the pages."""

from contextlib import nullcontext
from typing import Annotated, Any

import typer

from kg.cli.diagnostics import note
from kg.cli.options import Store, WatchdogSeconds
from kg.cli.session import session

__all__ = ["serve"]


def _option(name: str, metavar: str, text: str) -> Any:
    return typer.Option(name, metavar=metavar, help=text)


Host = Annotated[
    str | None,
    _option("--host", "ADDRESS", "Address to listen on. [default: 127.0.0.1, reachable from this machine only]"),
]
Port = Annotated[str | None, _option("--port", "N", "Port to listen on; 0 picks a free one. [default: 7878]")]
Write = Annotated[bool, typer.Option("--write", help="Accept updates from token holders.")]
TokenFile = Annotated[
    str | None, _option("--token-file", "FILE", "Read the token from FILE, and again if it changes. [KG_TOKEN]")
]
NoAuth = Annotated[bool, typer.Option("--no-auth", help="Allow reading without a token.")]
AllowHost = Annotated[list[str] | None, _option("--allow-host", "NAME", "Accept this host name too; may be repeated.")]
Cors = Annotated[
    list[str] | None, _option("--cors", "ORIGIN", "Allow pages of this site to read (CORS); may be repeated.")
]
NoUnion = Annotated[
    bool, typer.Option("--no-union", help="Use the unnamed graph as the default graph, not the union of all.")
]
Readers = Annotated[str | None, _option("--readers", "N", "Number of queries answered in parallel. [default: 2]")]
Queue = Annotated[str | None, _option("--queue", "N", "Maximum number of waiting queries. [default: 256]")]
Seconds = Annotated[str | None, _option("--timeout", "SECONDS", "Time limit of a query. [default: 30]")]
UpdateSeconds = Annotated[
    str | None, _option("--update-timeout", "SECONDS", "Time limit of an update, which is then undone. [default: 300]")
]
MaxRows = Annotated[str | None, _option("--max-rows", "N", "Maximum rows per answer. [default: 100000]")]
MaxAnswer = Annotated[str | None, _option("--max-answer-bytes", "SIZE", "Maximum size of an answer. [default: 1G]")]
MaxBody = Annotated[str | None, _option("--max-body-bytes", "SIZE", "Maximum size of a request. [default: 128M]")]
MaxMemory = Annotated[str | None, _option("--max-memory", "SIZE", "Memory limit of a query. [default: 2G]")]
Cache = Annotated[str | None, _option("--cache", "SIZE", "Size of the cache of answers. [default: 64M]")]
Grace = Annotated[
    str | None, _option("--grace", "SECONDS", "Time for running requests to finish on shutdown. [default: 10]")
]
Log = Annotated[str | None, _option("--log", "text|json|off", "Log a line for each request. [default: text]")]
Slow = Annotated[str | None, _option("--slow", "SECONDS", "Log queries that take longer.")]
SlowLog = Annotated[str | None, _option("--slow-log", "FILE", "Write slow queries to FILE.")]
Robot = Annotated[
    str | None,
    _option("--robot", "ADDRESS", "Show this robot on a page; token holders can move it: ros1://HOST:PORT, ..."),
]
Open = Annotated[bool, typer.Option("--open", help="Open the start page in the browser.")]


def serve(  # noqa: PLR0913 - the options of a command
    context: typer.Context,
    *,
    host: Host = None,
    port: Port = None,
    write: Write = False,
    token_file: TokenFile = None,
    no_auth: NoAuth = False,
    allow_host: AllowHost = None,
    cors: Cors = None,
    no_union: NoUnion = False,
    readers: Readers = None,
    queue: Queue = None,
    timeout: Seconds = None,
    update_timeout: UpdateSeconds = None,
    max_rows: MaxRows = None,
    max_answer_bytes: MaxAnswer = None,
    max_body_bytes: MaxBody = None,
    max_memory: MaxMemory = None,
    cache: Cache = None,
    grace: Grace = None,
    log: Log = None,
    slow: Slow = None,
    slow_log: SlowLog = None,
    robot: Robot = None,
    watchdog: WatchdogSeconds = None,
    open_page: Open = False,
    store: Store = None,
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

    texts = {
        "port": port, "token_file": token_file, "readers": readers, "queue": queue, "timeout": timeout,
        "update_timeout": update_timeout, "max_rows": max_rows, "max_answer_bytes": max_answer_bytes,
        "max_body_bytes": max_body_bytes, "max_memory": max_memory, "cache": cache, "grace": grace,
        "log": log, "slow": slow, "slow_log": slow_log,
    }  # fmt: skip
    chosen = options(
        texts,
        host=host or "127.0.0.1",
        write=write,
        open_to_all=no_auth,
        hosts=tuple(allow_host or ()),
        origins=tuple(cors or ()),
        union=not no_union,
        robot=robot,
    )
    settings = session(context).settings(store=store, watchdog=watchdog)
    # A robot can be used without a store; changes are refused without one, for they would be lost.
    with or_empty(settings) if robot and not write else nullcontext(settings) as served:
        if served is not settings:
            note("no store found, serving an empty one; `kg build` creates one")
        run(served, chosen, lambda address: announce(address, served, chosen, say=note, browse=open_page))
