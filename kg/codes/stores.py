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
        "Wait for the process named, or stop it.",
    ),
    "KG303": CodeEntry(
        "store damaged",
        "The store cannot be opened.",
        "`kg doctor` says what is wrong; `kg build` makes a new one from the sources.",
    ),
    "KG304": CodeEntry(
        "disk full",
        "The disk filled up while the store was written; the store is as it was before.",
        "Free some space and run the command again.",
    ),
    "KG305": CodeEntry(
        "store of another version",
        "The store was written by a version of `kg` with another layout.",
        "Build it again with `kg build`.",
    ),
    "KG306": CodeEntry(
        "store not writable",
        "The folder of the store cannot be written: its permissions, or a file system that is read-only.",
        "Change the permissions, or name another folder with `--store`.",
    ),
}
