"""State that a run of rules leaves for the next one: terms, columns graph by graph, inferred triples.

    .kg/cache/columns/12        of the run that saw, or made, generation 12

A long-running process keeps it in memory. A file holds a header of JSON and the arrays and spellings as they are in
memory. It is mapped, and what a small change needs of it is read; a digest over sums of its pages tells a damaged one.
"""

from __future__ import annotations

import json
import mmap
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache, partial
from hashlib import blake2b
from pathlib import Path
from typing import BinaryIO, Final

import numpy as np
from pyoxigraph import NamedNode

from kg.rules.columns import graph_name
from kg.rules.engine.facts import Facts, Keys, Packed
from kg.rules.engine.terms import Dictionary, Spellings
from kg.rules.recording import Names
from kg.store.layout import write_atomically

_FOLDER: Final = "columns"
_DIGEST_BYTES: Final = 16
_FORM: Final = b"kg columns 4"
"""Goes into the digest; another one for each arrangement of the file."""
_HEADER: Final = _DIGEST_BYTES + 8
"""Where the header begins, behind its length."""
_WORDS: Final = 512
"""Words of eight bytes of a page."""
_PIECE_BYTES: Final = 1 << 20


@dataclass(slots=True)
class Memory:
    """The state after a run: the generation it is of, the digest of the rules that it ran with, and their names.

    `asserted` is what any of the graphs and the files of rules state. `inferred` holds auxiliary triples too, which
    are not in the store; `written` is the content of the graph of inferred triples. So `graphs` and `written` have all
    triples of the generation, but for the record of builds.
    """

    generation: int | None
    digest: str
    names: Names
    dictionary: Dictionary
    graphs: dict[NamedNode | None, Packed] = field(default_factory=dict)
    asserted: Facts = field(default_factory=Facts)
    inferred: Facts = field(default_factory=Facts)
    written: Facts = field(default_factory=Facts)


def save(cache: Path, memory: Memory) -> None:
    """Write a memory below the folder `cache` and remove those of other runs; OSError when it cannot be written."""
    folder = cache / _FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    arrays: list[Keys] = []
    begins: dict[int, int] = {}
    sections: list[list[tuple[int, int, int]]] = []
    size = 0
    for facts in (memory.inferred, memory.asserted, memory.written):
        sections.append([])
        for predicate, keys in facts:
            if id(keys) not in begins:
                begins[id(keys)] = size
                arrays.append(keys)
                size += keys.size
            sections[-1].append((predicate, begins[id(keys)], keys.size))
    arrays += [part.words for part in memory.graphs.values()]
    pages = memory.dictionary.pages
    terms, texts = memory.dictionary.whole()
    header = {
        "digest": memory.digest,
        "names": [memory.names.inferred.value, memory.names.builds.value, memory.names.base, memory.names.vocabulary],
        "graphs": [(graph_name(graph), part.words.size) for graph, part in memory.graphs.items()],
        "sections": sections,
        "keys": sum(keys.size for keys in arrays),
        "terms": len(terms),
    }
    line = json.dumps(header, separators=(",", ":")).encode()
    line += b" " * (-len(line) % 8)  # arrays begin at a multiple of eight bytes
    length = len(line).to_bytes(_HEADER - _DIGEST_BYTES, "little")
    tables = [keys.data for keys in arrays] + [terms.ends.data, terms.sums.data, terms.order.data]

    def fill(file: BinaryIO) -> None:
        # Part by part: all in one piece would need its size in memory once more.
        parts: list[bytes | memoryview] = [bytes(_DIGEST_BYTES), length, line, *tables, *texts]
        read = 0
        for part in parts:
            file.write(part)
            read += memoryview(part).nbytes
            if pages is not None and read > _PIECE_BYTES:
                pages.release()
                read = 0
        file.seek(_DIGEST_BYTES)
        digest = _digest(iter(partial(file.read, _PIECE_BYTES), b""))
        file.seek(0)
        file.write(digest)

    write_atomically(folder / str(memory.generation), fill, durable=False)
    for path in folder.iterdir():
        if path.name != str(memory.generation):
            path.unlink(missing_ok=True)


def load(cache: Path, digest: str | None = None) -> Memory | None:
    """Return the memory of the last run below the folder `cache`; None if it is damaged, or of another digest."""
    folder = cache / _FOLDER
    numbers = [int(path.name) for path in folder.iterdir() if path.name.isdigit()] if folder.is_dir() else []
    if not numbers:
        return None
    try:
        with (folder / str(max(numbers))).open("rb") as file:
            content = memoryview(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))
    except (OSError, ValueError):  # an empty file cannot be mapped
        return None
    pieces = (content[begin : begin + _PIECE_BYTES] for begin in range(_DIGEST_BYTES, len(content), _PIECE_BYTES))
    if _digest(pieces) != content[:_DIGEST_BYTES]:
        return None
    return _read(content, max(numbers), digest)


def _read(content: memoryview, generation: int, digest: str | None) -> Memory | None:
    """Return the content of an intact file; None if it belongs to other rules than those of a digest."""
    size = int.from_bytes(content[_DIGEST_BYTES:_HEADER], "little")
    place = _HEADER + size
    header = json.loads(content[_HEADER:place].tobytes())
    if digest not in {header["digest"], None}:
        return None

    terms = header["terms"]
    keys = np.frombuffer(content, np.int64, header["keys"], place)
    ends = np.frombuffer(content, np.int64, terms + 1, place := place + keys.nbytes)
    sums = np.frombuffer(content, np.uint32, terms, place := place + ends.nbytes)
    order = np.frombuffer(content, np.uint32, terms, place := place + sums.nbytes)
    dictionary = Dictionary(Spellings(content[place + order.nbytes :], ends, sums, order))
    # Sets share arrays, as when they were saved: comparing these takes no time.
    array = cache(lambda begin, size: keys[begin : begin + size])
    inferred, asserted, written = (
        Facts({predicate: array(begin, size) for predicate, begin, size in section}) for section in header["sections"]
    )
    begin = keys.size - sum(size for _, size in header["graphs"])
    graphs = {
        NamedNode(name) if name else None: Packed(keys[begin : (begin := begin + size)])
        for name, size in header["graphs"]
    }
    own, builds, base, vocabulary = header["names"]
    names = Names(NamedNode(own), NamedNode(builds), base, vocabulary)
    return Memory(generation, header["digest"], names, dictionary, graphs, asserted, inferred, written)


def _digest(pieces: Iterable[bytes | memoryview]) -> bytes:
    """Return a digest that any change of a byte changes: of the sums of the words of each page.

    The content is given in pieces of whole pages, but for the last one.
    """
    digest = blake2b(digest_size=_DIGEST_BYTES, person=_FORM)
    for content in pieces:
        words = np.frombuffer(content, np.uint64, len(content) // 8)
        pages = words[: words.size // _WORDS * _WORDS].reshape(-1, _WORDS)
        digest.update(pages.sum(axis=1).tobytes())
        digest.update(content[pages.nbytes :])
    return digest.digest()
