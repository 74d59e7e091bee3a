"""The codes of updates: KG560 to KG569."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final = {
    "KG560": CodeEntry(
        "update failed",
        "An operation could not be carried out, as for a graph that is not there; nothing of the update happened.",
        "Read the message; SILENT lets operations on graphs go on.",
    ),
    "KG561": CodeEntry(
        "graph of kg's own",
        "The update would change the graph of what rules infer or the record of builds, which only kg writes.",
        "Leave these graphs out: change what they follow from, or run `kg rules run` or `kg build`.",
    ),
    "KG562": CodeEntry(
        "content does not parse",
        "The content that was sent for a graph is not valid in its format at the place given.",
        "Correct the content there.",
    ),
    "KG563": CodeEntry(
        "format of content",
        "The content of a graph was sent in a format that is not known, or that holds several graphs.",
        "Send Turtle, N-Triples, RDF/XML or JSON-LD, and say which.",
    ),
    "KG564": CodeEntry(
        "no such graph",
        "The graph that was to be removed is not in the store.",
        "`kg export` or a query over `GRAPH ?g` lists the graphs.",
    ),
    "KG565": CodeEntry(
        "two data sets",
        "The request named a data set by `using-graph-uri` or `using-named-graph-uri`, the update by USING or WITH.",
        "Keep one of them.",
    ),
    "KG566": CodeEntry(
        "backup is there",
        "Something has the name that the backup was to have.",
        "Name another folder or file.",
    ),
    "KG567": CodeEntry(
        "no backup",
        "What was to be restored is not there, is no backup, or is not whole; the store is as it was.",
        "Name a folder or a file that `kg backup` wrote.",
    ),
    "KG568": CodeEntry(
        "writer ended",
        "The process that makes changes ended before the change was made; another takes its place.",
        "Change less at once; if it happens again, report the update.",
    ),
}
