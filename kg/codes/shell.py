"""The codes of the shell: KG550 to KG554."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

CODES: Final = {
    "KG550": CodeEntry(
        "no terminal",
        "The shell needs a terminal, but standard input or output is not one.",
        "Start the shell in a terminal. In scripts, use `kg shell --once 'QUERY'` or `kg query`.",
    ),
    "KG551": CodeEntry(
        "no editor",
        "No editor is configured or found to open a line, or the editor did not start.",
        "Name one in the environment: `export EDITOR=nano`.",
    ),
    "KG552": CodeEntry(
        "file not here",
        "The file of the line to open is not on this machine.",
        "`kg status` lists the sources and their folders. To read your own checkout, use `kg build`.",
    ),
    "KG553": CodeEntry(
        "file not written",
        "A result could not be written to the named file.",
        "Name a file in an existing folder where you are allowed to write.",
    ),
    "KG554": CodeEntry(
        "invalid key file",
        "The key file names an unknown action or key, or assigns two actions to one key.",
        "Press F1 in the shell to list actions and keys. `docs/shell.md` describes the format.",
    ),
}
