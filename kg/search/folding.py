"""Which nodes are one to a user: variants of a node in its package, and copies of it in other packages.

Variants are the program, the nodelet and the component of one thing: their names are the same without the words
that tell the form (`EkfNodelet`, `ekf_node`), or one file declares both.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from kg.search.words import words

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from kg.search.documents import Document, PackageDocument

__all__ = ["bare_name", "groups", "order"]

_FORMS: Final = frozenset({"node", "nodelet", "component", "nodes", "main", "ros", "ros2", "exe"})

_KINDS: Final = {"executable": 0, "script": 1, "component": 2, "nodelet": 3, "plugin": 4}


def bare_name(name: str) -> str:
    """Return a name without its namespace and the words that tell its form."""
    last = name.rpartition("::")[2].rpartition("/")[2].removesuffix(".py")
    kept = [word for word in words(last) if word not in _FORMS]
    return " ".join(kept or words(last))


def groups(packages: Sequence[PackageDocument], nodes: Sequence[Document]) -> NDArray[np.int32]:
    """Return for each node the place of the first of its group."""
    family = _families(packages)
    first: dict[tuple[object, ...], int] = {}
    found = list(range(len(nodes)))
    for place, node in enumerate(nodes):
        owner = family[node.package]
        keys = [(owner, "name", bare_name(name)) for name in (node.name, *node.aliases)]
        known = [found[first[key]] for key in keys if key in first]
        if known:
            found[place] = min(known)
        for key in keys:
            first.setdefault(key, place)
    return np.array(found, np.int32)


def order(packages: Sequence[PackageDocument], nodes: Sequence[Document]) -> NDArray[np.int32]:
    """Return where each node stands among nodes of the same worth: the maintained first, then what is started."""

    def key(place: int) -> tuple[object, ...]:
        node, package = nodes[place], packages[nodes[place].package]
        version = [-int(part) if part.isdigit() else 0 for part in (package.version or "0").split(".")]
        return package.deprecated, -(node.ros or package.ros), _KINDS.get(node.kind, len(_KINDS)), version, place

    found = np.zeros(len(nodes), np.int32)
    for position, place in enumerate(sorted(range(len(nodes)), key=key)):
        found[place] = position
    return found


def _families(packages: Sequence[PackageDocument]) -> list[int]:
    """Return for each package the place of the first of its copies."""
    places = {package.iri: place for place, package in enumerate(packages)}
    found = list(range(len(packages)))
    for place, package in enumerate(packages):
        copies = [places[iri] for iri in package.copies if iri in places]
        found[place] = min([place, *(found[copy] for copy in copies)])
    return found
