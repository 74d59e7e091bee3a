"""`kg rules lsp`: the language server that editors start."""

import os
import sys
from pathlib import Path

import typer

from kg.cli.options import Store, takes
from kg.cli.session import session
from kg.errors import GraphError
from kg.lazily import lazily
from kg.settings import DECLARED

with lazily():
    from kg.editors.source import Source


@takes(DECLARED[one] for one in ("rules", "rule_families"))
def lsp(context: typer.Context, *, store: Store = None, **given: str | None) -> None:
    """Serve editors: rules as you type them, and the findings of `kg lint`.

    Rules get errors, fixes, completion, documentation, definitions, references and renaming. Launch files and code get
    the findings on the store in force. When a file is saved, its source is built again.

    Speaks the Language Server Protocol on standard input and output; docs/editors.md has configurations for editors.
    Needs the extra `lsp`: pip install 'kg-ros[lsp]'.
    """
    try:
        from kg.editors.server import language_server  # noqa: PLC0415 - start-up time
    except ImportError as error:
        raise GraphError("KG605", f"{error.name} is not installed", hint="pip install 'kg-ros[lsp]'") from error

    # The editor names the folder to work in later.
    store = store if store is None or "://" in store else str(Path(store).absolute())
    options = [f"--{name.replace('_', '-')}={value}" for name, value in given.items() if value]
    source = Source(lambda: session(context).settings(store=store, **given), options)
    # Copies: the server closes its streams when the editor leaves, and the command still has words to say.
    with (
        os.fdopen(os.dup(sys.stdin.fileno()), "rb") as reading,
        os.fdopen(os.dup(sys.stdout.fileno()), "wb") as writing,
    ):
        language_server(source).start_io(reading, writing)
