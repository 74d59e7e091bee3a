"""Cargo.toml: the names of the programs that a package in Rust installs. Its code is not read."""

from __future__ import annotations

import tomllib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader


def read_cargo(reader: Reader, folder: PackageFolder) -> tuple[str, ...]:
    """Return the programs of the crate in the package's folder: those listed, and the one named after the crate.

    Cargo makes the last one of `src/main.rs`.
    """
    path = folder.join("Cargo.toml")
    text = reader.read(path) if reader.workspace.owner(reader.file(path)) else None
    try:
        content: dict[str, Any] = tomllib.loads((text or b"").decode())
    except tomllib.TOMLDecodeError:
        return ()
    tables = [*_tables(content.get("bin")), *_tables(content.get("package"))]
    return tuple(dict.fromkeys(name for table in tables if isinstance(name := table.get("name"), str)))


def _tables(value: object) -> list[dict[str, Any]]:
    listed = value if isinstance(value, list) else [value]
    return [one for one in listed if isinstance(one, dict)]
