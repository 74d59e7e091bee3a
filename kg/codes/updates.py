"""The codes of updates: KG560 to KG569."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

CODES: Final = {
    "KG560": CodeEntry(
        "update failed",
        "An operation of the update failed, for example because its graph does not exist. The whole update was undone.",
        "Read the message. With SILENT, operations on graphs ignore errors.",
    ),
    "KG561": CodeEntry(
        "reserved graph",
        "The update would change the graph of inferred facts or the record of builds. Only kg writes these.",
        "Change the facts that they depend on instead, or run `kg rules run` or `kg build`.",
    ),
    "KG562": CodeEntry(
        "content does not parse",
        "The content sent for a graph is not valid in its format at the place given.",
        "Correct the content there.",
    ),
    "KG563": CodeEntry(
        "unsupported format of content",
        "The format of the content is unknown, or contains several graphs.",
        "Send Turtle, N-Triples, RDF/XML or JSON-LD, and declare the format.",
    ),
    "KG564": CodeEntry(
        "graph not found",
        "The graph to remove is not in the store.",
        "List the graphs with `kg export` or a query over `GRAPH ?g`.",
    ),
    "KG565": CodeEntry(
        "conflicting data sets",
        "The request sets the data set by `using-graph-uri` or `using-named-graph-uri`. The update sets it by USING "
        "or WITH.",
        "Keep one of them.",
    ),
    "KG566": CodeEntry(
        "backup target exists",
        "The file or folder of the backup already exists.",
        "Name another folder or file.",
    ),
    "KG567": CodeEntry(
        "not a backup",
        "The backup is missing, incomplete, or not a backup. The store is unchanged.",
        "Name a folder or a file that `kg backup` wrote.",
    ),
    "KG568": CodeEntry(
        "writer process ended",
        "The writer process ended before the change was complete. Another one replaced it.",
        "Change less at once. If it happens again, report the update.",
    ),
}
