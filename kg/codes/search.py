"""The codes of searching, composing and evaluating: KG7xx."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

CODES: Final = {
    "KG701": CodeEntry(
        "unknown type in a filter",
        "No node of the store uses the type that a filter names, in a topic, service or action.",
        "Use one of the types suggested, or remove the filter. Tab completes types.",
    ),
    "KG702": CodeEntry(
        "unknown hardware, function or capability in a filter",
        "No node of the store has the hardware, function or capability that a filter names.",
        "Use one of the names suggested, or describe it in the words of the search.",
    ),
    "KG703": CodeEntry(
        "unknown licence, package, kind or version in a filter",
        "No node of the store has the licence, package, kind or ROS version that a filter names.",
        "Use one of the values suggested, or remove the filter.",
    ),
    "KG704": CodeEntry(
        "embedding model not loaded",
        "The model of sentence embeddings is not a model folder, cannot be loaded, or lacks its library.",
        "Name a folder that contains a model, install `kg-ros[semantic]`, or compare without a model.",
    ),
    "KG705": CodeEntry(
        "type not used by startable nodes",
        "No node that a launch file starts publishes or subscribes to messages of this type.",
        "Check the name, `package/Type` or `Type`. `kg topics` lists topics and their types.",
    ),
    "KG706": CodeEntry(
        "no chain of nodes",
        "No sequence of nodes of one ROS version converts messages of the first type to the second.",
        "Try another type or longer chains (`--length`), or build sources that contain the missing node.",
    ),
    "KG707": CodeEntry(
        "unknown waypoint of a chain",
        "A chain must pass through something that is not in the store as a type, node, package or word.",
        "Check the name. `kg nodes` lists the nodes. `kg topics` lists the topics and their types.",
    ),
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
