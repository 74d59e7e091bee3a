"""The codes of evaluations: KG72x."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final = {
    "KG721": CodeEntry(
        "references cannot be read",
        "A file of references is not there, is no UTF-8, or has a line that is no reference.",
        "Correct the line; docs/evaluation.md shows what such a file looks like.",
    ),
    "KG722": CodeEntry(
        "sheet of sampled facts",
        "A sheet that `kg eval sample --score` reads is no CSV, lacks a column, or has an answer that is none.",
        "Write yes, no or unsure into the column `right`, or leave it empty.",
    ),
    "KG723": CodeEntry(
        "package of a page",
        "A page of documentation stands in no package of the store, or the package named with it is not there.",
        "Name the package with `--package NAME` or `--package REPOSITORY:NAME`.",
    ),
    "KG724": CodeEntry(
        "library of a comparison missing",
        "A way to rank nodes that the search is compared with needs a library that is not installed.",
        "Install it as the message says: `pip install 'kg-ros[evaluate]'` brings them.",
    ),
    "KG725": CodeEntry(
        "needs cannot be read",
        "A file of needs is not there, has no need, or has a line that is none.",
        "Correct the line; docs/evaluation.md shows what such a file looks like.",
    ),
}
