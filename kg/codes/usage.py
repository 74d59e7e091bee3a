"""The codes of usage and settings: KG0xx."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

CODES: Final = {
    "KG001": CodeEntry(
        "unknown name",
        "The store has no node, package, query or other thing of this name.",
        "Use one of the names suggested, or list them with `kg nodes` or `kg query --list`.",
    ),
    "KG002": CodeEntry(
        "bad setting",
        "The value of a flag, an environment variable or a line of kg.toml is not valid.",
        "Correct the value. `kg config show` lists the origin of each value.",
    ),
    "KG003": CodeEntry(
        "bad argument",
        "The arguments of the command conflict, or one of them is not valid.",
        "See the command's `--help`.",
    ),
    "KG004": CodeEntry(
        "out of memory",
        "The command needs more memory than the setting `memory` or `ulimit -v` allows. The store is unchanged.",
        "Raise the limit, use fewer processes (`--jobs 1`), or build fewer sources at once.",
    ),
}
