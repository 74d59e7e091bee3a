"""The codes of usage and settings: KG0xx."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final = {
    "KG001": CodeEntry(
        "unknown name",
        "A node, package, query or other name is not in the store.",
        "Use one of the names suggested, or list them with `kg nodes` or `kg query --list`.",
    ),
    "KG002": CodeEntry(
        "bad setting",
        "A flag, an environment variable or a line of kg.toml has a value that cannot be used.",
        "Correct the value; `kg config show` tells where each value comes from.",
    ),
    "KG003": CodeEntry(
        "bad argument",
        "The command was called with arguments that do not go together.",
        "See the command's `--help`.",
    ),
    "KG004": CodeEntry(
        "out of memory",
        "The command needs more memory than the setting `memory` or `ulimit -v` allows. The store is as it was before.",
        "Raise the limit, read fewer packages at a time (`--jobs 1`), or build fewer sources at once.",
    ),
}
