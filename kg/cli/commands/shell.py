"""`kg shell`: the store on the whole terminal."""

from typing import Annotated, Any

import typer

from kg.cli.completion import queries as query_names
from kg.cli.options import Store, takes
from kg.cli.session import session
from kg.errors import Exit
from kg.lazily import lazily
from kg.settings import DECLARED

with lazily():
    from kg.cli.commands.query import query
    from kg.shell.running import run

Once = Annotated[
    str | None,
    typer.Option(
        "--once",
        metavar="QUERY",
        help="Answer QUERY (SPARQL, or the name of a stored query) like `kg query` and exit.",
        autocompletion=query_names,
    ),
]


@takes(DECLARED[one] for one in ("format", "limit", "timeout", "queries"))
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

    code = run(session(context).settings(store=store, **given))
    if code != Exit.OK:
        raise typer.Exit(code)
