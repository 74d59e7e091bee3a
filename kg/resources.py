"""Where the files that belong to `kg` but are no code stand: ontologies, rules, queries, examples, criteria.

In a checkout they stand at the top level; the wheel carries them as `kg/_data`.
"""

from __future__ import annotations

from pathlib import Path

__all__ = ["folder"]

_PACKAGE = Path(__file__).resolve().parent


def folder(name: str) -> Path:
    """Return the folder `corpus`, `ontology`, `rules`, `queries` or `examples` of this installation."""
    installed = _PACKAGE / "_data" / name
    return installed if installed.is_dir() else _PACKAGE.parent / name
