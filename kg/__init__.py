"""`kg`: an embedded SPARQL triplestore with reasoning rules, for ROS nodes and the capabilities of robots.

The names below are the public API. Each is loaded on first use, so `import kg` is fast.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kg.api import build, compose, find, findings, infer, instances, nodes, open_store, rdflib_dataset, sparql
    from kg.errors import (
        Exit,
        GraphError,
        KgError,
        Place,
        QueryError,
        RuleError,
        SourceError,
        StoreError,
        UsageError,
    )

__all__ = [
    "Exit",
    "GraphError",
    "KgError",
    "Place",
    "QueryError",
    "RuleError",
    "SourceError",
    "StoreError",
    "UsageError",
    "__version__",
    "build",
    "compose",
    "find",
    "findings",
    "infer",
    "instances",
    "nodes",
    "open_store",
    "rdflib_dataset",
    "sparql",
]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version  # noqa: PLC0415 - rarely used; it searches the installation

        return version("kg-ros")
    if name in __all__:
        return getattr(import_module("kg.api" if name.islower() else "kg.errors"), name)  # functions; classes of errors
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
