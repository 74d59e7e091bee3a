"""The codes of evaluations: KG72x."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

CODES: Final = {
    "KG721": CodeEntry(
        "references cannot be read",
        "A file of references is missing, is not UTF-8, or has an invalid line.",
        "Correct the line. docs/evaluation.md describes the format.",
    ),
    "KG722": CodeEntry(
        "invalid sheet of sampled facts",
        "A sheet for `kg eval sample --score` is not CSV, lacks a column, or has an invalid answer.",
        "Write yes, no or unsure into the column `right`, or leave it empty.",
    ),
    "KG723": CodeEntry(
        "page without package",
        "A page of documentation belongs to no package of the store, or its named package is missing.",
        "Name the package with `--package NAME` or `--package REPOSITORY:NAME`.",
    ),
    "KG724": CodeEntry(
        "library for a comparison missing",
        "A ranking method for the comparison needs a library that is not installed.",
        "Install the library that the message names, or all of them with `pip install 'kg-ros[evaluate]'`.",
    ),
    "KG725": CodeEntry(
        "needs cannot be read",
        "A file of needs is missing, is empty, or has an invalid line.",
        "Correct the line. docs/evaluation.md describes the format.",
    ),
}
