"""The codes of the store: KG3xx."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

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
    "KG307": CodeEntry(
        "snapshot not usable",
        "What `kg pull` fetched is not what `kg publish` wrote. Its manifest is malformed, or a digest differs.",
        "Check the address. If it is right, ask whoever published it to do so again.",
    ),
    "KG308": CodeEntry(
        "snapshot too large",
        "A published snapshot is larger than the limit of `kg pull`, or than the size in its manifest.",
        "Raise the limit with `--max-bytes` if you trust the address.",
    ),
    "KG309": CodeEntry(
        "not supported by a remote store",
        "The command needs the store itself, and `--store` names a SPARQL server.",
        "Pull a snapshot of it with `kg pull`, or use one of the commands that docs/cluster.md lists.",
    ),
}
