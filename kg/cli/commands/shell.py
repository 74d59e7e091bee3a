"""`kg shell`: the store on the whole terminal."""

from typing import Annotated

import typer

from kg.cli.completion import queries as query_names
from kg.cli.options import Format, Limit, Queries, Store, Timeout
from kg.cli.session import session
from kg.errors import Exit

Once = Annotated[
    str | None,
    typer.Option(
        "--once",
        metavar="QUERY",
        help="Answer QUERY (SPARQL, or the name of a stored query) like `kg query` and exit.",
        autocompletion=query_names,
    ),
]


def shell(  # noqa: PLR0913 - the options of a command
    context: typer.Context,
    *,
    once: Once = None,
    format_name: Format = None,
    limit: Limit = None,
    timeout: Timeout = None,
    queries: Queries = None,
    store: Store = None,
) -> None:
    """Explore the store in a full-screen terminal interface.

    It has a tree of the store, queries, evidence, proofs, search and rules. F1 shows all keys, Ctrl+P runs any action
    by name, Ctrl+Q quits. Buffers and history are kept between runs. For example:

        kg shell
        kg --store demo shell
        kg shell --once 'SELECT ?node { ?node a rnkg:NodeType }' --format csv
    """
    if once is not None:
        from kg.cli.commands.query import query  # noqa: PLC0415 - the branch that needs it

        stores = [store] if store else None
        query(context, once, format_name=format_name, limit=limit, timeout=timeout, queries=queries, store=stores)
        return
    from kg.shell.running import run  # noqa: PLC0415 - start-up time

    code = run(
        session(context).settings(store=store, format=format_name, limit=limit, timeout=timeout, queries=queries)
    )
    if code != Exit.OK:
        raise typer.Exit(code)
