"""Data files of `kg`: ontologies, rules, queries, examples, criteria.

In a checkout they are at the top level; in the wheel they are in `kg/_data`.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Final

__all__ = ["digest", "folder", "table_of"]

_BYTES: Final = 16
_BYTECODE: Final = "__pycache__"

_PACKAGE = Path(__file__).resolve().parent


def folder(name: str) -> Path:
    """Return the folder `corpus`, `ontology`, `rules`, `queries`, `examples` or `docs` of this installation.

    The wheel contains only the error codes of `docs`.
    """
    installed = _PACKAGE / "_data" / name
    return installed if installed.is_dir() else _PACKAGE.parent / name


def table_of(name: str, file: str) -> dict[str, Any]:
    """Return the content of a TOML file in one of the folders."""
    import tomllib  # noqa: PLC0415 - start-up time

    return tomllib.loads((folder(name) / file).read_text("utf-8"))


def digest(roots: Iterable[Path]) -> str:
    """Return the digest of the names and contents of files, and of all files in folders, except Python's bytecode."""
    hashed = hashlib.blake2b(digest_size=_BYTES)
    for root in roots:
        for path in sorted(_files(root)):
            content = path.read_bytes()
            name = str(path.relative_to(root.parent))
            hashed.update(f"{len(name)} {len(content)} {name}".encode("utf-8", "surrogateescape"))
            hashed.update(content)
    return hashed.hexdigest()


def _files(root: Path) -> Iterable[Path]:
    if root.is_file():
        yield root
    for folder_path, folders, names in os.walk(root):
        folders[:] = [name for name in folders if name != _BYTECODE]
        yield from (Path(folder_path, name) for name in names if not name.endswith(".pyc"))
