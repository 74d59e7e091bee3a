"""The codes of the search: KG70x."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

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
}
