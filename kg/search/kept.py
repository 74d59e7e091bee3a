"""Files in the store's cache: one of a kind, for one content of the store, checked before it is believed.

What is damaged, or was written by other code or from other data, is none: who asks makes it anew. Nothing in such a
file is run, for its readers decode JSON and arrays of numbers only.
"""

from __future__ import annotations

import zlib
from contextlib import suppress
from functools import cache
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg import resources
from kg.store.layout import write_atomically

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["keep", "kept"]

_CHECKSUM_BYTES: Final = 4
_DATA: Final = ("search.toml", "composing.toml")
"""Files in the folder `ontology` that what is kept depends on."""


def keep(folder: Path, generation: str, parts: Iterable[bytes]) -> None:
    """Write what belongs to a generation into a folder, and remove what belongs to others.

    Raises:
        OSError: it could not be written; what was kept before is as it was.
    """
    folder.mkdir(parents=True, exist_ok=True)
    body = b"".join(parts)
    write_atomically(folder / generation, _checksum(body) + body, durable=False)
    for path in folder.iterdir():
        if path.name != generation and not path.name.endswith(".tmp"):
            with suppress(OSError):
                path.unlink()


def kept(folder: Path, generation: str) -> bytes | None:
    """Return what was kept for a generation; None where that is nothing, or nothing that can be used."""
    try:
        content = (folder / generation).read_bytes()
    except OSError:
        return None
    body = content[_CHECKSUM_BYTES:]
    return body if content[:_CHECKSUM_BYTES] == _checksum(body) else None


def _checksum(body: bytes) -> bytes:
    """Return a checksum of a content that is another one for other code or data."""
    return zlib.crc32(body, _version()).to_bytes(_CHECKSUM_BYTES, "little")


@cache
def _version() -> int:
    """Return a number for the code of this room and the data that it reads."""
    code = sorted(Path(__file__).resolve().parent.rglob("*.py"))
    digest = blake2b(digest_size=_CHECKSUM_BYTES)
    for path in (*code, *(resources.folder("ontology") / name for name in _DATA)):
        digest.update(path.read_bytes())
    return int.from_bytes(digest.digest(), "little")
