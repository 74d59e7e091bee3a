"""Files in the store's cache: one of a kind, for one content of the store, checked before it is used.

A file that is damaged, or that other code or other data wrote, counts as missing: the caller computes its content
again. Nothing in such a file is run, for its readers decode JSON and arrays of numbers only.
"""

from __future__ import annotations

import zlib
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from kg.store.layout import write_atomically

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

_CHECKSUM_BYTES: Final = 4


def keep(folder: Path, generation: str, version: int, parts: Iterable[bytes]) -> None:
    """Write what belongs to a generation into a folder, and remove what belongs to others.

    `version` is another number for other code that computes it, of at most 32 bits.

    Raises:
        OSError: it could not be written; what was kept before is as it was.
    """
    folder.mkdir(parents=True, exist_ok=True)
    body = b"".join(parts)
    write_atomically(folder / generation, _checksum(body, version) + body, durable=False)
    for path in folder.iterdir():
        if path.name != generation and not path.name.endswith(".tmp"):
            with suppress(OSError):
                path.unlink()


def kept(folder: Path, generation: str, version: int) -> bytes | None:
    """Return what was kept for a generation; None where that is nothing, or nothing that can be used."""
    try:
        content = (folder / generation).read_bytes()
    except OSError:
        return None
    body = content[_CHECKSUM_BYTES:]
    return body if content[:_CHECKSUM_BYTES] == _checksum(body, version) else None


def _checksum(body: bytes, version: int) -> bytes:
    """Return a checksum of a content that is another one for another version."""
    return zlib.crc32(body, version).to_bytes(_CHECKSUM_BYTES, "little")
