"""The index of the search on disk: one file a generation, marked with the version of its code and data.

A file holds a line of JSON that describes the parts, and the parts themselves: JSON and arrays. Documents are decoded
one by one, when a hit shows them.
"""

from __future__ import annotations

import fcntl
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from hashlib import blake2b
from pathlib import Path
from typing import Any, Final

import msgspec
import numpy as np

from kg import resources
from kg.search import words
from kg.search.documents import Document, PackageDocument
from kg.search.index import NEIGHBOURS, Columns, Index
from kg.search.reading import Concept
from kg.store import cachefile

_FOLDER: Final = "search"
_COLUMNS: Final = ("text", "names", "features")
_ARRAYS: Final = {"group": np.int32, "order": np.int32, "started": np.float32, "near": np.int32, "shares": np.float32}
_PARTS: Final = {"starts": np.int64, "rows": np.int32, "values": np.float32}
"""The arrays of an index, and of each of its columns, with their types."""


class _Header(msgspec.Struct):
    names: dict[str, list[str]]
    sizes: dict[str, int]


class Documents:
    """The documents of nodes in their order, decoded on access."""

    def __init__(self, content: bytes, starts: Any) -> None:
        self._content, self._starts = content, starts

    def __len__(self) -> int:
        return len(self._starts) - 1

    def __getitem__(self, place: int) -> Document:
        if not 0 <= place < len(self):
            raise IndexError(place)
        part = self._content[self._starts[place] : self._starts[place + 1]]
        return msgspec.json.decode(part, type=Document)


@contextmanager
def alone(cache: Path) -> Iterator[None]:
    """Lock the right to build an index in the folder `cache`, so it is built once for all waiting processes.

    In a read-only store there is no lock, and each process builds its own.
    """
    try:
        (cache / _FOLDER).mkdir(parents=True, exist_ok=True)
        file = (cache / _FOLDER / "building").open("a")
    except OSError:
        yield
        return
    with file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def save(cache: Path, generation: str, index: Index) -> None:
    """Write an index to the folder `cache` and delete those of other generations; OSError if it cannot be written."""
    parts = dict(_parts(index))
    names = {one: sorted(getattr(index, one).names, key=getattr(index, one).names.get) for one in _COLUMNS}
    header = _Header(names, {name: len(content) for name, content in parts.items()})
    keep(cache / _FOLDER, generation, (msgspec.json.encode(header), b"\n", *parts.values()))


def load(cache: Path, generation: str) -> Index | None:
    """Return the index of a generation from the folder `cache`; None if there is no usable one."""
    content = load_cached(cache / _FOLDER, generation)
    if content is None:
        return None
    end = content.index(b"\n")
    return _index(msgspec.json.decode(content[:end], type=_Header), content, end + 1)


def _parts(index: Index) -> Iterator[tuple[str, bytes]]:
    encoded = [msgspec.json.encode(index.nodes[place]) for place in range(index.size)]
    yield "starts", np.cumsum([0, *map(len, encoded)], dtype=np.int64).tobytes()
    yield "nodes", b"".join(encoded)
    yield "packages", msgspec.json.encode(list(index.packages))
    yield "concepts", msgspec.json.encode(list(index.concepts))
    yield "passing", msgspec.json.encode(sorted(index.passing))
    yield from ((name, getattr(index, name).tobytes()) for name in _ARRAYS)
    for name in _COLUMNS:
        yield from ((f"{name}.{part}", getattr(getattr(index, name), part).tobytes()) for part in _PARTS)


def _index(header: _Header, content: bytes, at: int) -> Index:
    parts: dict[str, bytes] = {}
    for name, size in header.sizes.items():
        parts[name] = content[at : at + size]
        at += size
    arrays: dict[str, Any] = {name: np.frombuffer(parts[name], kind) for name, kind in _ARRAYS.items()}
    arrays |= {name: arrays[name].reshape(-1, NEIGHBOURS) for name in ("near", "shares")}
    columns: dict[str, Any] = {
        name: Columns(
            {term: place for place, term in enumerate(header.names[name])},
            *(np.frombuffer(parts[f"{name}.{part}"], kind) for part, kind in _PARTS.items()),
        )
        for name in _COLUMNS
    }
    return Index(
        packages=msgspec.json.decode(parts["packages"], type=list[PackageDocument]),
        nodes=Documents(parts["nodes"], np.frombuffer(parts["starts"], np.int64)),
        concepts=msgspec.json.decode(parts["concepts"], type=list[Concept]),
        passing=msgspec.json.decode(parts["passing"], type=frozenset[str]),
        **columns,
        **arrays,
    )


_VERSION_BYTES: Final = 4
_DATA: Final = (*words.FILES, "composing.toml")  # files in the folder `ontology` that what is kept depends on


def keep(folder: Path, generation: str, parts: Iterable[bytes]) -> None:
    """Write the content of a generation to a folder, and delete that of others.

    Raises OSError: it could not be written; the previous files are unchanged.
    """
    cachefile.save(folder, generation, _version(), parts)


def load_cached(folder: Path, generation: str) -> bytes | None:
    """Return the cached content of a generation; None if missing or unusable."""
    return cachefile.load(folder, generation, _version())


@cache
def _version() -> int:
    """Return a checksum of the code of this package and its data files."""
    code = sorted(Path(__file__).resolve().parent.rglob("*.py"))
    digest = blake2b(digest_size=_VERSION_BYTES)
    for path in (*code, *(resources.folder("ontology") / name for name in _DATA)):
        digest.update(path.read_bytes())
    return int.from_bytes(digest.digest(), "little")
