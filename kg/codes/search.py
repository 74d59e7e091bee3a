"""The codes of the search: KG70x."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final = {
    "KG701": CodeEntry(
        "type in a filter",
        "No node of the store publishes, subscribes, offers or calls something of the type that a filter names.",
        "Use one of the types named, or leave the filter out; Tab completes them.",
    ),
    "KG702": CodeEntry(
        "hardware, function or capability in a filter",
        "No node of the store was found to use the hardware, have the function or give the capability named.",
        "Use one of the names given, or say it in the words of the search.",
    ),
    "KG703": CodeEntry(
        "licence, package, kind or version in a filter",
        "No node of the store is under the licence, in the package, of the kind or for the version of ROS named.",
        "Use one of the values named, or leave the filter out.",
    ),
    "KG704": CodeEntry(
        "model of sentence embeddings",
        "The model that searches by meaning is no folder with a model, cannot be loaded, or its library is not there.",
        "Name a folder that holds a model, install `kg-ros[semantic]`, or search without a model.",
    ),
}
