"""Where the program `kg` starts."""

from __future__ import annotations

import sys

__all__ = ["run"]


def run() -> None:
    """Run the command line of this process; even an interruption while modules load ends in one line."""
    try:
        from kg.cli.app import app  # noqa: PLC0415 - so that Ctrl-C is caught while this loads

        app()
    except KeyboardInterrupt:
        sys.stderr.write("\ninterrupted\n")
        sys.exit(130)
