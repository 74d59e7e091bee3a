"""Cached results of extraction: the compressed N-Triples of a package, its own and those shared by sources.

They are preceded by the look-ups that they depend on, the starts of its launch files, its descriptions and its node
types.

A file is named by the digest of its content, so damaged or foreign files are detected, and concurrent builds do not
interfere.
"""

from __future__ import annotations

import hashlib
import json
import zlib
from typing import TYPE_CHECKING, Final

from kg.lazily import lazily
from kg.store.layout import write_atomically

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from kg.facts import Description, LaunchConfiguration
    from kg.graph.nodes import Stated
    from kg.pipeline.recording import Lookup

with lazily():
    from msgspec import msgpack

_LEVEL: Final = 1
_ENDING: Final = ".z"
_LENGTH_BYTES: Final = 8
_LOOKUPS, _SHARED, _LAUNCHES, _DESCRIPTIONS, _NODES, _CONTENT = range(6)


def pack(  # noqa: PLR0913, PLR0917 - the parts of a result
    content: bytes,
    answers: Mapping[Lookup, str],
    common: bytes = b"",
    configurations: tuple[LaunchConfiguration, ...] = (),
    texts: tuple[Description, ...] = (),
    stated: tuple[Stated, ...] = (),
) -> bytes:
    """Return the packed form of N-Triples, the look-ups (with results) that they depend on, and shared N-Triples.

    It also contains the configurations of the package's launch files, its annotated descriptions, and its node types.
    """
    listed = json.dumps([[*lookup, answer] for lookup, answer in sorted(answers.items())], separators=(",", ":"))
    encode = msgpack.encode
    parts = [
        zlib.compress(part, _LEVEL)
        for part in (listed.encode(), common, encode(configurations), encode(texts), encode(stated), content)
    ]
    return b"".join(len(part).to_bytes(_LENGTH_BYTES) + part for part in parts)


def store(folder: Path, packed: bytes) -> str:
    """Write a packed result and return its name; OSError if it cannot be written."""
    name = hashlib.blake2b(packed, digest_size=16).hexdigest()
    write_atomically(folder / f"{name}{_ENDING}", packed, durable=False)
    return name


def triples(folder: Path, name: str) -> bytes | None:
    """Return the N-Triples of a result; None if it is missing or damaged."""
    return _part(folder, name, _CONTENT)


def shared(folder: Path, name: str) -> bytes | None:
    """Return the N-Triples of a result that sources share; None if it is missing or damaged."""
    return _part(folder, name, _SHARED)


def lookups(folder: Path, name: str) -> dict[Lookup, str] | None:
    """Return the look-ups that a result depends on, with their results; None if it is missing or damaged."""
    packed = _read(folder, name)
    return None if packed is None else lookups_of(packed)


def launches(folder: Path, name: str) -> tuple[LaunchConfiguration, ...] | None:
    """Return the configurations of a package's launch files; None if the result is missing or damaged."""
    from kg.facts import LaunchConfiguration  # noqa: PLC0415 - a build without changes opens no result

    part = _part(folder, name, _LAUNCHES)
    return None if part is None else msgpack.decode(part, type=tuple[LaunchConfiguration, ...])


def descriptions(folder: Path, name: str) -> tuple[Description, ...]:
    """Return the annotated descriptions of a package; empty if the result is missing or damaged."""
    from kg.facts import Description  # noqa: PLC0415 - the same

    part = _part(folder, name, _DESCRIPTIONS)
    return () if part is None else msgpack.decode(part, type=tuple[Description, ...])


def nodes(folder: Path, name: str) -> tuple[Stated, ...]:
    """Return the node types of a package; empty if the result is missing or damaged."""
    from kg.graph.nodes import Stated  # noqa: PLC0415 - the same

    part = _part(folder, name, _NODES)
    return () if part is None else msgpack.decode(part, type=tuple[Stated, ...])


def exists(folder: Path, name: str) -> bool:
    """Return whether a result exists, without reading it."""
    return (folder / f"{name}{_ENDING}").exists()


def keep_only(folder: Path, names: Iterable[str]) -> None:
    """Delete all other results, and partial files of a killed build."""
    needed = {f"{name}{_ENDING}" for name in names}
    for path in folder.iterdir():
        if path.name not in needed and (path.suffix in {_ENDING, ".tmp"}):
            path.unlink(missing_ok=True)


def lookups_of(packed: bytes) -> dict[Lookup, str]:
    """Return the look-ups that a packed result depends on, with their results."""
    return {tuple(lookup): answer for *lookup, answer in json.loads(_part_of(packed, _LOOKUPS))}


def _part(folder: Path, name: str, number: int) -> bytes | None:
    packed = _read(folder, name)
    return None if packed is None else _part_of(packed, number)


def _part_of(packed: bytes, number: int) -> bytes:
    start = 0
    for _ in range(number):
        start += _LENGTH_BYTES + _length(packed, start)
    return zlib.decompress(packed[start + _LENGTH_BYTES : start + _LENGTH_BYTES + _length(packed, start)])


def _length(packed: bytes, start: int) -> int:
    return int.from_bytes(packed[start : start + _LENGTH_BYTES])


def _read(folder: Path, name: str) -> bytes | None:
    try:
        packed = (folder / f"{name}{_ENDING}").read_bytes()
    except OSError:
        return None
    return packed if hashlib.blake2b(packed, digest_size=16).hexdigest() == name else None
