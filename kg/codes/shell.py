"""The codes of the shell: KG550 to KG554."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final = {
    "KG550": CodeEntry(
        "no terminal",
        "The shell was started where standard input or output is no terminal.",
        "Start it in a terminal; scripts use `kg shell --once 'QUERY'` or `kg query`.",
    ),
    "KG551": CodeEntry(
        "no editor",
        "A line was to be opened, and no editor is named or found, or it could not be started.",
        "Name one in the environment: `export EDITOR=nano`.",
    ),
    "KG552": CodeEntry(
        "file not here",
        "A line was to be opened whose file is not on this machine.",
        "`kg status` lists the sources and where they were read; `kg build` reads a checkout of yours.",
    ),
    "KG553": CodeEntry(
        "file not written",
        "An answer could not be written to the file that was named.",
        "Name a file in a folder that exists and that you may write to.",
    ),
    "KG554": CodeEntry(
        "wrong keys",
        "The file of keys names an action or a key that there is not, or gives one key two meanings.",
        "F1 in the shell shows actions and keys; `docs/shell.md` says how the file is written.",
    ),
}
