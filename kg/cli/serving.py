"""What `kg serve` reads and says before it serves."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING
from urllib.parse import quote

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kg.server.options import Options
    from kg.settings import Settings


def options(given: Mapping[str, object]) -> Options:
    """Return the options of a server: flags by names of fields, then variables and `kg.toml`; the token is `$KG_TOKEN`.

    Raises UsageError KG002 for a value that cannot be used.
    """
    from kg.server.options import DECLARED, Options  # noqa: PLC0415 - start-up time
    from kg.settings import load_table  # noqa: PLC0415 - start-up time

    return Options(token=os.environ.get("KG_TOKEN") or None, **load_table(DECLARED, given))


def announce(address: str, settings: Settings, options: Options, *, say: Callable[[str], None], browse: bool) -> None:
    """Say where the server listens, what of, and to whom; with `browse` open its start page."""
    from kg.server.libraries import HELP, libraries  # noqa: PLC0415 - start-up time
    from kg.store.opening import layout_of  # noqa: PLC0415 - start-up time

    data = "unnamed graph" if options.no_union else "union of all graphs"
    say(f"serving {layout_of(settings).name} at {address}")
    say(f"SPARQL at {address}sparql (default graph: {data}), graphs at {address}store")
    say("changes: from clients with the token" if options.write else "changes: none; `--write` allows them")
    if options.robot:
        who = (
            "by clients with the token"
            if options.token or options.token_file
            else "by nobody; set KG_TOKEN to allow it"
        )
        say(f"robot {options.robot} at {address}robot (moved {who})")
    if (token := _token(options)) and sys.stderr.isatty():  # where this is written to a file, the token stays out of it
        say(f"log in: {address}login#token={quote(token, safe='')}")
    if not libraries():
        say(f"pages have no pictures and a plain editor: their libraries are not installed. {HELP}")
    if browse:
        import webbrowser  # noqa: PLC0415 - with the branch that needs it

        webbrowser.open(address)


def _token(options: Options) -> str | None:
    """Return the token of a server, None where it has none."""
    from kg.server.safety.tokens import Tokens  # noqa: PLC0415 - start-up time

    return Tokens(options.token, options.token_file).current
