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
    str | None, _option("--host", "ADDRESS", "Listen there. [default: 127.0.0.1, which only this machine reaches]")
]
Port = Annotated[str | None, _option("--port", "N", "Listen at this port, or at a free one: 0. [default: 7878]")]
Write = Annotated[bool, typer.Option("--write", help="Take changes too, from who has the token.")]
TokenFile = Annotated[
    str | None, _option("--token-file", "FILE", "Read the token from FILE, again when it changes. [KG_TOKEN]")
]
NoAuth = Annotated[bool, typer.Option("--no-auth", help="Let everyone read who reaches the address.")]
AllowHost = Annotated[
    list[str] | None, _option("--allow-host", "NAME", "Answer to this name of the host too; as often as needed.")
]
Cors = Annotated[list[str] | None, _option("--cors", "ORIGIN", "Let pages of this site read; as often as needed.")]
NoUnion = Annotated[
    bool, typer.Option("--no-union", help="Let the default graph be the unnamed one, not the union of all.")
]
Readers = Annotated[str | None, _option("--readers", "N", "Answer N queries at a time. [default: 2]")]
Queue = Annotated[str | None, _option("--queue", "N", "Let N queries wait. [default: 256]")]
Seconds = Annotated[str | None, _option("--timeout", "SECONDS", "End a query after that. [default: 30]")]
UpdateSeconds = Annotated[
    str | None, _option("--update-timeout", "SECONDS", "End a change after that, undone. [default: 300]")
]
MaxRows = Annotated[str | None, _option("--max-rows", "N", "Send at most N rows at a time. [default: 100000]")]
MaxAnswer = Annotated[str | None, _option("--max-answer-bytes", "SIZE", "Hold answers up to that. [default: 1G]")]
MaxBody = Annotated[str | None, _option("--max-body-bytes", "SIZE", "Take requests up to that. [default: 128M]")]
MaxMemory = Annotated[str | None, _option("--max-memory", "SIZE", "Give each query up to that. [default: 2G]")]
Cache = Annotated[
    str | None, _option("--cache", "SIZE", "Keep answers up to that for who asks the same again. [default: 64M]")
]
Grace = Annotated[
    str | None, _option("--grace", "SECONDS", "When told to stop, let requests end for that long. [default: 10]")
]
Log = Annotated[str | None, _option("--log", "text|json|off", "Write a line for each request. [default: text]")]
Slow = Annotated[str | None, _option("--slow", "SECONDS", "Write down queries that take longer.")]
SlowLog = Annotated[str | None, _option("--slow-log", "FILE", "Write them to FILE.")]
Robot = Annotated[
    str | None,
    _option("--robot", "ADDRESS", "Show this robot on a page; who has the token may move it: ros1://HOST:PORT, ..."),
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
    """Serve the store: pages for people, a SPARQL endpoint for programs.

    It listens on this machine only and changes nothing, until told otherwise. It follows builds: each
    request is answered from the newest data. With --robot it needs no store. Ctrl-C ends it. For example:

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
            note("no store found: serving an empty one; `kg build` makes one")
        run(served, chosen, lambda address: announce(address, served, chosen, say=note, browse=open_page))
