"""Columns of the triples that a transaction writes into an empty store, which saves reading them back."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from pyoxigraph import NamedNode, RdfFormat, parse

from kg.rules.columns import by_predicate, graph_name, packed, rows_of
from kg.rules.engine.facts import Keys, Packed, Shelf
from kg.rules.engine.pages import Pages
from kg.rules.engine.terms import Dictionary
from kg.store.changes import Changes
from kg.store.files import opened
from kg.store.terms import BLANK_MARK, parts_of_lines, split_blank

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

_BATCH_BYTES: Final = 1 << 20


class Written(Changes):
    """Changes of an empty store, with the triples of each graph as long as all of them are known."""

    def __init__(self, cache: Path) -> None:
        """Most of the triples are in a file of the folder `cache`."""
        super().__init__()
        self._pages = Pages(cache)
        self._dictionary = Dictionary(pages=self._pages)
        self._parts: dict[str, list[Packed]] | None = {}
        """For each graph what was read together: pairs in any order, and any number of times."""
        self._shelf = Shelf(self._pages)
        self._unknown: set[str] = set()
        self._graph = ""
        self._waiting: list[bytes] = []
        self._bytes = 0

    def begin(self, graph: str, terms: Sequence[bytes], columns: Mapping[int, bytes]) -> None:
        """Begin with the content of a graph, as `so_far` returned it, before anything else is noted."""
        super().replace(graph)
        self._dictionary = Dictionary.of(terms, self._pages)
        whole = Packed.of((predicate, np.frombuffer(keys, np.int64)) for predicate, keys in columns.items())
        self._parts = {graph: [self._shelf.add(whole)]}

    def so_far(self, graph: str) -> tuple[list[bytes], dict[int, bytes]]:
        """Return the terms noted so far, and the pairs of each predicate of a graph; both are known."""
        self._read()
        terms = self._dictionary.spellings(range(1, len(self._dictionary)))
        return terms, {predicate: keys.tobytes() for predicate, keys in self._gathered(graph)}

    def forget(self) -> None:
        """Note that any graph may have changed."""
        super().forget()
        self._parts = None

    def replace(self, *graphs: str) -> None:
        """Note that some graphs have a content that is not known."""
        super().replace(*graphs)
        self._unknown.update(graphs)

    def clear(self, *graphs: str) -> None:
        """Note that some graphs were emptied."""
        super().replace(*graphs)
        self._read()
        self._unknown.difference_update(graphs)
        if self._parts is not None:
            self._parts.update({graph: [] for graph in graphs})

    def load(self, graph: str, lines: bytes) -> None:
        """Note that N-Triples were added to a graph."""
        super().replace(graph)
        self._add(graph, lines)

    def load_file(self, graph: str, path: Path, rdf_format: RdfFormat) -> None:
        """Note that the content of a file was added to a graph: N-Triples without blank nodes, which get new labels."""
        super().replace(graph)
        if rdf_format != RdfFormat.N_TRIPLES:
            self._unknown.add(graph)
            return
        with opened(path) as file:
            rest = b""
            while piece := file.read(_BATCH_BYTES):
                whole, end, rest = (rest + piece).rpartition(b"\n")
                if BLANK_MARK in whole:
                    self._unknown.add(graph)
                    return
                self._add(graph, whole + end)
            if BLANK_MARK in rest:
                self._unknown.add(graph)
            elif rest.strip():
                self._add(graph, rest + b"\n")

    def patch(self, graph: str, removed: bytes, added: bytes) -> None:
        """Note that triples were taken out of a graph, and then others put in."""
        super().patch(graph, removed, added)
        if removed.strip():
            self._unknown.add(graph)
        self._add(graph, added)

    def _add(self, graph: str, lines: bytes) -> None:
        if self._parts is None or graph in self._unknown:
            return
        if graph != self._graph:
            self._read()
            self._graph = graph
        self._waiting.append(lines)
        self._bytes += len(lines)
        if self._bytes > _BATCH_BYTES:
            self._read()

    def _read(self) -> None:
        """Put the lines that wait into columns."""
        lines = b"".join(self._waiting)
        self._waiting, self._bytes = [], 0
        if self._parts is None or self._graph in self._unknown:
            return
        part = Packed.of(by_predicate(_rows(lines, self._dictionary)))
        if len(part):
            self._parts.setdefault(self._graph, []).append(self._shelf.add(part))

    def _gathered(self, graph: str) -> Packed:
        """Return the triples of a graph."""
        columns: dict[int, list[Keys]] = {}
        for part in (self._parts or {}).get(graph, ()):
            for predicate, keys in part:
                columns.setdefault(predicate, []).append(keys)
        return packed(columns, self._pages)

    def count(self, graph: str) -> int | None:
        """Return the number of triples in a graph, None if they are not known."""
        self._read()
        known = self._parts is not None and graph in self._parts and graph not in self._unknown
        return len(self._gathered(graph)) if known else None

    def take(self, graphs: list[NamedNode | None]) -> tuple[Dictionary, dict[NamedNode | None, Packed]]:
        """Return the triples of those graphs that are known, and keep no more from now on."""
        self._read()
        known = [one for one in graphs if self._parts is not None and graph_name(one) not in self._unknown]
        result = {graph: self._shelf.add(self._gathered(graph_name(graph))) for graph in known}
        self._shelf.move()
        dictionary = self._dictionary
        self._parts, self._dictionary = None, Dictionary()
        self._pages.release()
        return dictionary, result


def _rows(lines: bytes, dictionary: Dictionary) -> NDArray[np.int64]:
    """Return N-Triples as rows of identifiers, as a store spells the terms; blank nodes keep their labels."""
    plain, others = split_blank(lines)
    parts = parts_of_lines(plain)
    if parts is None:
        return rows_of(parse(lines, RdfFormat.N_TRIPLES, lenient=True), dictionary)
    rows = dictionary.intern_all(parts).reshape(-1, 3)
    if not others:
        return rows
    return np.concatenate([rows, rows_of(parse(others, RdfFormat.N_TRIPLES, lenient=True), dictionary)])
