"""Nodes rarely wanted unless named: tests, examples, demonstrations, old versions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.search.words import terms

if TYPE_CHECKING:
    from kg.search.documents import Document, PackageDocument

TESTS: Final = frozenset(("test", "tester", "mock", "fake", "debug", "benchmark"))
"""Stems of words in names and folders of nodes that are for the developers of a package."""
MARKS: Final = TESTS | {"exampl", "demo", "sampl", "tutori", "simul", "rviz", "gui", "gazebo", "legaci", "old"}
"""Stems of words in names and folders of nodes that are rarely wanted unless requested."""


def marks(node: Document, package: PackageDocument) -> set[str]:
    """Return the stems that lower the rank of a node, from its name, its package and the folders of its file."""
    folders = node.path.rpartition("/")[0]
    return {term for term in terms(f"{node.name} {package.name} {folders}") if term in MARKS}
