"""The descriptions of a package and its nodes, from all texts that the package and its repository have about them."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Final

from kg.extract.texts.documents import of_documents
from kg.extract.texts.launching import of_launch_files
from kg.extract.texts.manifest import of_manifest, of_plugins
from kg.extract.texts.sources import of_sources

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader
    from kg.extract.buildmodel import BuildModel
    from kg.facts import Description, NodeType

__all__ = ["MOST_OF_ONE", "read_descriptions"]

MOST_OF_ONE: Final = 24
"""Paragraphs that are kept of one node, and of the package: what it does is told in the first of them."""


def read_descriptions(
    reader: Reader, package: PackageFolder, build: BuildModel, nodes: tuple[NodeType, ...]
) -> tuple[Description, ...]:
    """Return what people wrote about a package and its nodes, in the order of the places; what is said twice, once.

    Texts are read as `reader` reads them, so that each is an input of the result. Nothing in them makes it raise.
    """
    found = [
        *of_manifest(reader, package),
        *of_plugins(build, nodes),
        *of_sources(reader, package, build, nodes),
        *of_documents(reader, package, nodes),
        *of_launch_files(reader, package, nodes),
    ]
    return tuple(sorted(_bounded(found), key=_place))


def _bounded(found: Iterable[Description]) -> Iterator[Description]:
    seen: set[tuple[str | None, str]] = set()
    counts: Counter[str | None] = Counter()
    for one in found:
        said = (one.node, one.text.casefold())
        if said not in seen and counts[one.node] < MOST_OF_ONE:
            seen.add(said)
            counts[one.node] += 1
            yield one


def _place(one: Description) -> tuple[str, int, str, str]:
    return one.location.path, one.location.line, one.node or "", one.text
