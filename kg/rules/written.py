"""Columns of the triples that a transaction writes into an empty store, which saves reading them back."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from pyoxigraph import NamedNode, RdfFormat, parse

from kg.rules.columns import by_predicate, graph_name, rows_of
from kg.rules.engine.facts import Facts, gathered
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
        self._columns: dict[str, dict[int, list[NDArray[np.int64]]]] | None = {}
        self._unknown: set[str] = set()
        self._graph = ""
        self._waiting: list[bytes] = []
        self._bytes = 0

    def begin(self, graph: str, terms: Sequence[bytes], columns: Mapping[int, bytes]) -> None:
        """Begin with the content of a graph, as `so_far` returned it, before anything else is noted."""
        super().replace(graph)
        self._dictionary = Dictionary.of(terms, self._pages)
        self._columns = {graph: {predicate: [np.frombuffer(keys, np.int64)] for predicate, keys in columns.items()}}

    def so_far(self, graph: str) -> tuple[list[bytes], dict[int, bytes]]:
        """Return the terms noted so far, and the pairs of each predicate of a graph; both are known."""
        self._read()
        columns = gathered((self._columns or {}).get(graph, {}))
        terms = self._dictionary.spellings(range(1, len(self._dictionary)))
        return terms, {predicate: keys.tobytes() for predicate, keys in columns}

    def forget(self) -> None:
        """Note that any graph may have changed."""
        super().forget()
        self._columns = None

    def replace(self, *graphs: str) -> None:
        """Note that some graphs have a content that is not known."""
        super().replace(*graphs)
        self._unknown.update(graphs)

    def clear(self, *graphs: str) -> None:
        """Note that some graphs were emptied."""
        super().replace(*graphs)
        self._read()
        self._unknown.difference_update(graphs)
        if self._columns is not None:
            self._columns.update({graph: {} for graph in graphs})

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
        if self._columns is None or graph in self._unknown:
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
        if self._columns is None or self._graph in self._unknown:
            return
        columns = self._columns.setdefault(self._graph, {})
        tables = list(by_predicate(_rows(lines, self._dictionary)))
        if not tables:
            return
        every = self._pages.store(np.concatenate([keys for _, keys in tables]))
        begin = 0
        for predicate, keys in tables:
            columns.setdefault(predicate, []).append(every[begin : begin + keys.size])
            begin += keys.size

    def take(self, graphs: list[NamedNode | None]) -> tuple[Dictionary, dict[NamedNode | None, Facts]]:
        """Return the triples of those graphs that are known, and keep no more from now on."""
        self._read()
        result: dict[NamedNode | None, Facts] = {}
        columns = self._columns or {}
        for graph in graphs if self._columns is not None else ():
            name = graph_name(graph)
            if name not in self._unknown:
                result[graph] = gathered(columns.pop(name, {}), self._pages)
        dictionary = self._dictionary
        self._columns, self._dictionary = None, Dictionary()
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
