"""Packages for one test, and the content of their build files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from extract.workspaces import reader_of

from kg.extract.manifests import read_build

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from kg.corpus.reading import Reader
    from kg.extract.buildmodel import BuildModel

__all__ = ["cmake", "links", "model_of", "sources"]


def model_of(reader: Reader) -> BuildModel:
    """Return the build model of a reader's package."""
    return read_build(reader, reader.package)


def cmake(root: Path, text: str, files: Iterable[str] = (), **more: str) -> BuildModel:
    """Return the build model of a package `demo` with this CMakeLists.txt, empty `files`, and `more` with content."""
    content = dict.fromkeys(files, "") | more | {"CMakeLists.txt": text}
    return model_of(reader_of(root, content))


def sources(model: BuildModel) -> dict[str, list[str]]:
    """Return the sources of each target, relative to the package."""
    return {target.name: [path.removeprefix("demo/") for path in target.sources] for target in model.targets}


def links(model: BuildModel) -> dict[str, list[str]]:
    """Return what each target links."""
    return {target.name: list(target.links) for target in model.targets}
