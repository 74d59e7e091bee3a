"""Group nodes that are equivalent to a user: variants of a node in its package, and copies of it in other packages.

Variants are the program, the nodelet and the component of one node. Their names are equal without the words for the
form (`EkfNodelet`, `ekf_node`), or they have the same interfaces from the same lines.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Final

import numpy as np

from kg.search.words import words

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from kg.search.documents import Document, End, PackageDocument

_FORMS: Final = frozenset({"node", "nodelet", "component", "nodes", "main", "ros", "ros2", "exe"})

_STARTED: Final = ("executable", "script")
_LOADED: Final = ("nodelet", "component", "plugin")
TRANSFORM_TYPES: Final = ("tf2_msgs/TFMessage", "tf/tfMessage")
_LEAST: Final = 2  # so many interfaces in common are no chance
_KINDS: Final = {"executable": 0, "script": 1, "component": 2, "nodelet": 3, "plugin": 4}


def bare_name(name: str) -> str:
    """Return a name without its namespace and the words for its form."""
    last = name.rpartition("::")[2].rpartition("/")[2].removesuffix(".py")
    significant = [word for word in words(last) if word not in _FORMS]
    return " ".join(significant or words(last))


def groups(packages: Sequence[PackageDocument], nodes: Sequence[Document]) -> NDArray[np.int32]:
    """Return the index of the first node of each node's group."""
    family = _families(packages)
    first: dict[tuple[object, ...], int] = {}
    first_of = list(range(len(nodes)))
    for place, node in enumerate(nodes):
        keys = [(family[node.package], bare_name(name)) for name in (node.name, *node.aliases)]
        earlier = [first_of[first[key]] for key in keys if key in first]
        if earlier:
            first_of[place] = min(earlier)
        for key in keys:
            first.setdefault(key, place)
    _join_wrappers(nodes, first_of)
    return np.array(first_of, np.int32)


def _join_wrappers(nodes: Sequence[Document], groups_of: list[int]) -> None:
    """Add programs that only start a nodelet or component to its group.

    Such a program has all interfaces of the other, from the same lines. If there are several candidates, such as nodes
    with the same base class, the right one shares a word of its name that is in no rival's name.
    """
    packages: defaultdict[int, tuple[list[int], list[int]]] = defaultdict(lambda: ([], []))
    for place, node in enumerate(nodes):
        if node.kind in _STARTED or node.kind in _LOADED:
            packages[node.package][node.kind in _LOADED].append(place)
    for programs, loaded in packages.values():
        ends = {place: frozenset(filter(_is_own, nodes[place].ends)) for place in (*programs, *loaded)}
        partners = {one: [other for other in loaded if _wraps(ends[one], ends[other])] for one in programs}
        for program, others in partners.items():
            rivals = [one for one in programs if one != program and set(partners[one]) & set(others)]
            partner = _partner(nodes, program, rivals, others)
            if partner is not None:
                old, new = groups_of[program], groups_of[partner]
                groups_of[:] = [min(old, new) if group in {old, new} else group for group in groups_of]


def _is_own(end: End) -> bool:
    """Return whether an interface shows a wrapped node: transforms do not, which are found by calls."""
    return end.type not in TRANSFORM_TYPES


def _wraps(program: frozenset[End], loaded: frozenset[End]) -> bool:
    return len(loaded) >= _LEAST and loaded <= program


def _partner(nodes: Sequence[Document], program: int, rivals: Sequence[int], others: Sequence[int]) -> int | None:
    if len(others) == 1 and not rivals:
        return others[0]
    named = set(bare_name(nodes[program].name).split())
    named -= {word for rival in rivals for word in bare_name(nodes[rival].name).split()}
    sharing = [place for place in others if named & set(bare_name(nodes[place].name).split())]
    return sharing[0] if len(sharing) == 1 else None


def order(packages: Sequence[PackageDocument], nodes: Sequence[Document]) -> NDArray[np.int32]:
    """Return the rank of each node among nodes with equal scores: maintained packages first, then programs."""

    def key(place: int) -> tuple[object, ...]:
        node, package = nodes[place], packages[nodes[place].package]
        version = [-int(part) if part.isdigit() else 0 for part in (package.version or "0").split(".")]
        return package.deprecated, -(node.ros or package.ros), _KINDS.get(node.kind, len(_KINDS)), version, place

    ranks = np.zeros(len(nodes), np.int32)
    for position, place in enumerate(sorted(range(len(nodes)), key=key)):
        ranks[place] = position
    return ranks


def is_main(node: Document, package: PackageDocument, variants: int, others: int) -> bool:
    """Return whether texts about a package describe this node: it is the only one, or has the package's name.

    `variants` is the number of its variants including itself, `others` the number of nodes in the package.
    """
    names = {bare_name(name).replace(" ", "") for name in (node.name, *node.aliases)}
    return variants == others or bare_name(package.name).replace(" ", "") in names


def _families(packages: Sequence[PackageDocument]) -> list[int]:
    """Return the index of the first copy of each package."""
    places = {package.iri: place for place, package in enumerate(packages)}
    first_copies = list(range(len(packages)))
    for place, package in enumerate(packages):
        copies = [places[iri] for iri in package.copies if iri in places]
        first_copies[place] = min([place, *(first_copies[copy] for copy in copies)])
    return first_copies
