"""Workspaces for one test: files given as text, read like by a build."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.corpus.reading import Reader
from kg.corpus.workspace import Workspace, scan

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from kg.facts import Problem

__all__ = ["codes", "manifest", "reader_of", "written"]


def manifest(name: str) -> str:
    """Return the smallest package.xml of a package `name`."""
    return f"<package format='3'><name>{name}</name><version>1.0.0</version><description>d</description></package>"


def written(root: Path, files: Mapping[str, str | bytes]) -> Workspace:
    """Write the files below `root` and return the workspace of that one source."""
    for path, content in files.items():
        target = root / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content if isinstance(content, bytes) else content.encode())
    return Workspace([scan(root)])


def reader_of(root: Path, files: Mapping[str, str | bytes], package: str = "demo") -> Reader:
    """Return a reader for the package `demo` with these files in its folder; other packages are in `../NAME`."""
    placed = {f"demo/{path}".replace("demo/../", ""): content for path, content in files.items()}
    placed.setdefault("demo/package.xml", manifest("demo"))
    workspace = written(root, placed)
    found = workspace.package(package)
    assert found is not None
    return Reader(workspace, *workspace.folder(found))


def codes(problems: tuple[Problem, ...]) -> list[tuple[str, int | None]]:
    """Return code and line of each problem."""
    return [(found.code, found.line) for found in problems]
