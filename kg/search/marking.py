"""Nodes that are rarely meant by who does not say so: tests, examples, demonstrations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.search.words import terms

if TYPE_CHECKING:
    from kg.search.documents import Document, PackageDocument

__all__ = ["MARKED_DOWN", "marks"]

MARKED_DOWN: Final = {
    "test": 0.7,
    "exampl": 0.8,
    "demo": 0.8,
    "sampl": 0.8,
    "tutori": 0.7,
    "mock": 0.8,
    "fake": 0.8,
    "simul": 0.9,
    "rviz": 0.8,
    "gui": 0.9,
    "gazebo": 0.9,
}
"""Stems of words of names and folders of nodes that are rarely meant by who does not say so."""


def marks(node: Document, package: PackageDocument) -> set[str]:
    """Return the stems that mark a node down, of its name, its package and the folders of its file."""
    folders = node.path.rpartition("/")[0]
    return {term for term in terms(f"{node.name} {package.name} {folders}") if term in MARKED_DOWN}
