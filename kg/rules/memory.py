"""What a run of rules leaves for the next one: terms, columns graph by graph, what was inferred.

    .kg/cache/columns/12        of the run that saw, or made, generation 12

A process that stays keeps it in memory. A file holds one line of JSON, the spellings of all terms joined by ends of
lines, and the arrays as they are in memory; a digest over all of it tells a damaged one.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from hashlib import blake2b
from typing import TYPE_CHECKING, Final

import numpy as np
from pyoxigraph import NamedNode

from kg.rules.engine.facts import Facts
from kg.rules.engine.terms import Dictionary
from kg.store.layout import write_atomically

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kg.rules.engine.facts import Keys

__all__ = ["Memory", "load", "save"]

_FOLDER: Final = "columns"
_DIGEST_BYTES: Final = 16
_INFERRED: Final = "inferred"
"""Stands for what was inferred among the names of graphs, which are IRIs, or empty for the default graph."""


@dataclass(slots=True)
class Memory:
    """The state after a run: the generation it is of, and the digest of the rules and names that it ran with.

    `inferred` holds auxiliary triples too, which are not in the store.
    """

    generation: int | None
    digest: str
    dictionary: Dictionary
    graphs: dict[NamedNode | None, Facts] = field(default_factory=dict)
    inferred: Facts = field(default_factory=Facts)


def save(cache: Path, memory: Memory) -> None:
    """Write a memory below the folder `cache` and remove those of other runs; OSError when it cannot be written."""
    folder = cache / _FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    sections: list[tuple[str, int, int]] = []
    arrays: list[Keys] = []
    for name, facts in _parts(memory):
        for predicate, keys in facts:
            sections.append((name, predicate, keys.size))
            arrays.append(keys)
    spellings = b"\n".join(memory.dictionary.spellings(range(1, len(memory.dictionary))))
    graphs = ["" if graph is None else graph.value for graph in memory.graphs]
    header = {"digest": memory.digest, "graphs": graphs, "sections": sections, "spellings": len(spellings)}
    # Arrays begin at a multiple of eight bytes.
    line = json.dumps(header).encode()
    line += b" " * (-(_DIGEST_BYTES + len(line) + 1 + len(spellings)) % 8) + b"\n"
    content = b"".join([line, spellings, *(keys.tobytes() for keys in arrays)])
    write_atomically(folder / str(memory.generation), _digest(content) + content, durable=False)
    for path in folder.iterdir():
        if path.name != str(memory.generation):
            path.unlink(missing_ok=True)


def load(cache: Path, digest: str) -> Memory | None:
    """Return the memory of the last run below the folder `cache`; None when it is of other rules, or damaged."""
    folder = cache / _FOLDER
    numbers = [int(path.name) for path in folder.iterdir() if path.name.isdigit()] if folder.is_dir() else []
    if not numbers:
        return None
    try:
        content = (folder / str(max(numbers))).read_bytes()
    except OSError:
        return None
    if _digest(memoryview(content)[_DIGEST_BYTES:]) != content[:_DIGEST_BYTES]:
        return None
    end = content.index(b"\n", _DIGEST_BYTES)
    header = json.loads(content[_DIGEST_BYTES:end])
    if header["digest"] != digest:
        return None
    place = end + 1 + header["spellings"]
    dictionary = Dictionary.of(content[end + 1 : place].split(b"\n"))
    memory = Memory(max(numbers), digest, dictionary, {_graph(name): Facts() for name in header["graphs"]})
    for name, predicate, size in header["sections"]:
        keys = np.frombuffer(content, np.int64, size, place)
        place += keys.nbytes
        (memory.inferred if name == _INFERRED else memory.graphs[_graph(name)]).replace(predicate, keys)
    return memory


def _parts(memory: Memory) -> Iterator[tuple[str, Facts]]:
    for graph, facts in memory.graphs.items():
        yield "" if graph is None else graph.value, facts
    yield _INFERRED, memory.inferred


def _graph(name: str) -> NamedNode | None:
    return NamedNode(name) if name else None


def _digest(content: bytes | memoryview) -> bytes:
    return blake2b(content, digest_size=_DIGEST_BYTES).digest()
