"""Checked files in the store's cache: one per folder, for one generation of the store.

A file that is damaged, or of other code or other data, counts as missing: the caller computes its content again. Such
files are safe to read, because they only contain JSON and arrays of numbers.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Final

from kg.store.layout import write_atomically

_CHECKSUM_BYTES: Final = 4


def save(folder: Path, generation: str, version: int, parts: Iterable[bytes]) -> None:
    """Write the cache file of a generation into a folder, and delete those of other generations.

    `version` is a number of at most 32 bits that changes with the code that computes the content.

    Raises:
        OSError: it could not be written; the previous files are unchanged.
    """
    folder.mkdir(parents=True, exist_ok=True)
    body = b"".join(parts)
    write_atomically(folder / generation, _checksum(body, version) + body, durable=False)
    for path in folder.iterdir():
        if path.name != generation and not path.name.endswith(".tmp"):
            with suppress(OSError):
                path.unlink()


def load(folder: Path, generation: str, version: int) -> bytes | None:
    """Return the cached content for a generation; None if it is missing or invalid."""
    try:
        content = (folder / generation).read_bytes()
    except OSError:
        return None
    body = content[_CHECKSUM_BYTES:]
    return body if content[:_CHECKSUM_BYTES] == _checksum(body, version) else None


def _checksum(body: bytes, version: int) -> bytes:
    """Return a checksum of a content and its version."""
    return zlib.crc32(body, version).to_bytes(_CHECKSUM_BYTES, "little")
