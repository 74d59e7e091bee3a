"""Where `kg shell` starts: a terminal and a store are checked first, so that what is missing is said in plain lines."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from kg.errors import StoreError, UsageError
from kg.store.opening import layout_of

if TYPE_CHECKING:
    from kg.settings import Settings


def run(settings: Settings) -> int:
    """Run the shell until the person leaves; return the exit code.

    Raises:
        UsageError: KG550 without a terminal, KG554 for a wrong file of keys.
        StoreError: KG301 without a store, or with an empty one.
    """
    layout = layout_of(settings)
    if layout.current() is None:
        raise StoreError("KG301", f"the store {layout.root} is empty", hint="Run `kg build FOLDER` first.")
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        hint = "In scripts ask with `kg shell --once 'QUERY'`, or with `kg query`."
        raise UsageError("KG550", "the shell needs a terminal, but standard input or output is not one", hint=hint)
    from kg.shell.app import Shell  # noqa: PLC0415 - what was checked above needs no textual
    from kg.shell.keys import chosen_actions, keys_file  # noqa: PLC0415 - as above

    shell = Shell(settings, layout, actions=chosen_actions(keys_file()))
    shell.run()
    return shell.return_code or 0
