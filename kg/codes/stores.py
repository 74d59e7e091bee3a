"""The codes of the store: KG3xx."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final = {
    "KG301": CodeEntry(
        "no store",
        "No store was found in this folder or the folders above it.",
        "Run `kg build FOLDER` or `kg demo`, or name the store with `--store`.",
    ),
    "KG302": CodeEntry(
        "store busy",
        "Another process is writing the store.",
        "Wait for the process that the message names, or stop it.",
    ),
    "KG303": CodeEntry(
        "store damaged",
        "The store cannot be opened. Its files might be damaged.",
        "Run `kg doctor` for details. `kg build` builds a new store from the sources.",
    ),
    "KG304": CodeEntry(
        "disk full",
        "The disk was full while `kg` wrote the store. The store is unchanged.",
        "Free some space and run the command again.",
    ),
    "KG305": CodeEntry(
        "store of another version",
        "Another version of `kg`, with another layout, wrote the store.",
        "Build it again with `kg build`.",
    ),
    "KG306": CodeEntry(
        "store not writable",
        "The folder of the store is not writable: its permissions forbid it, or the file system is read-only.",
        "Change the permissions, or name another folder with `--store`.",
    ),
}
