r"""Changes of each generation, which show what cached graphs are still valid.

    .kg/changes/12      {"base": 11, "graphs": {"https://w3id.org/rnkg/graph/shared": null,
                                                "": [["<a> <b> <c> .\n", ""]]}}

The empty name is the default graph. A graph has its patches (removed, added), or null if its new content is unknown. If
`graphs` is null, any graph may have changed. The file of a generation is written before the generation becomes current,
and deleted when it is old.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Final, TypeAlias

from kg.store.layout import Layout, write_atomically

if TYPE_CHECKING:
    from pathlib import Path

    from pyoxigraph import RdfFormat


_KEPT: Final = 64
_MOST_BYTES: Final = 1 << 20
"""Larger patches of a generation are not stored: reading the graph is as fast."""

Patches: TypeAlias = "list[tuple[bytes, bytes]] | None"
"""N-Triples removed and added, in order; None if unknown."""


class Changes:
    """Changes: `graphs` maps each changed graph to its patches, and is None if any graph may have changed."""

    def __init__(self, graphs: dict[str, Patches] | None = None) -> None:
        self.graphs: dict[str, Patches] | None = {} if graphs is None else graphs

    @classmethod
    def unknown(cls) -> Changes:
        """Return unknown changes of any graph."""
        changes = cls()
        changes.graphs = None
        return changes

    def forget(self) -> None:
        """Record that any graph may have changed."""
        self.graphs = None

    def replace(self, *graphs: str) -> None:
        """Record that graphs have unknown new content."""
        if self.graphs is not None:
            self.graphs.update(dict.fromkeys(graphs))

    def clear(self, *graphs: str) -> None:
        """Record that graphs were cleared."""
        self.replace(*graphs)

    def load(self, graph: str, lines: bytes) -> None:  # noqa: ARG002 - for subclasses that store them
        """Record that N-Triples were added to a graph, without storing them."""
        self.replace(graph)

    def load_file(self, graph: str, path: Path, rdf_format: RdfFormat) -> None:  # noqa: ARG002 - as `load`
        """Record that the content of a file was added to a graph, without storing it."""
        self.replace(graph)

    def patch(self, graph: str, removed: bytes, added: bytes) -> None:
        """Record that triples were removed from a graph, and then others added."""
        if self.graphs is None:
            return
        patches = self.graphs.setdefault(graph, [])
        if patches is not None:
            patches.append((removed, added))

    def count(self, graph: str) -> int | None:  # noqa: ARG002 - for subclasses that store triples
        """Return the number of triples in a graph, None if they are not stored here."""
        return None

    def follow(self, later: Changes) -> None:
        """Append later changes."""
        if later.graphs is None:
            self.graphs = None
        for name, patches in (later.graphs or {}).items():
            if patches is None:
                self.replace(name)
            for removed, added in patches or ():
                self.patch(name, removed, added)

    def record(self, layout: Layout, generation: int, base: int | None) -> None:
        """Write the changes of `generation` relative to `base`; OSError if they cannot be written."""
        folder = _folder(layout)
        folder.mkdir(parents=True, exist_ok=True)
        graphs = None if self.graphs is None else {name: _written(lines) for name, lines in self.graphs.items()}
        content = json.dumps({"base": base, "graphs": graphs})
        write_atomically(folder / str(generation), content.encode(), durable=False)
        for path in folder.iterdir():
            if path.name.isdigit() and int(path.name) <= generation - _KEPT:
                path.unlink(missing_ok=True)


def since(layout: Layout, earlier: int, later: int) -> Changes:
    """Return the changes from one generation to another."""
    steps: list[Changes] = []
    number: int | None = later
    while number != earlier:
        if number is None or number < earlier:
            return Changes.unknown()
        try:
            recorded = json.loads((_folder(layout) / str(number)).read_bytes())
            number, graphs = recorded["base"], recorded["graphs"]
            steps.append(Changes({name: _read(patches) for name, patches in graphs.items()}))
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            return Changes.unknown()
    every = Changes()
    for step in reversed(steps):
        every.follow(step)
    return every


def _folder(layout: Layout) -> Path:
    return layout.root / "changes"


def _written(patches: Patches) -> list[list[str]] | None:
    if patches is None or sum(len(removed) + len(added) for removed, added in patches) > _MOST_BYTES:
        return None
    return [[removed.decode(), added.decode()] for removed, added in patches]


def _read(patches: list[list[str]] | None) -> Patches:
    return None if patches is None else [(removed.encode(), added.encode()) for removed, added in patches]
