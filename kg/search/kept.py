"""Cache files of the search (`kg.store.kept`), valid for the code and the data that write them."""

from __future__ import annotations

from functools import cache
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg import resources
from kg.store import kept as files

if TYPE_CHECKING:
    from collections.abc import Iterable

_VERSION_BYTES: Final = 4
_DATA: Final = ("search.toml", "composing.toml")
"""Files in the folder `ontology` that the cached content depends on."""


def keep(folder: Path, generation: str, parts: Iterable[bytes]) -> None:
    """Write the content of a generation to a folder, and delete that of others.

    Raises:
        OSError: it could not be written; the previous files are unchanged.
    """
    files.keep(folder, generation, _version(), parts)


def kept(folder: Path, generation: str) -> bytes | None:
    """Return the cached content of a generation; None if missing or unusable."""
    return files.kept(folder, generation, _version())


@cache
def _version() -> int:
    """Return a checksum of the code of this package and its data files."""
    code = sorted(Path(__file__).resolve().parent.rglob("*.py"))
    digest = blake2b(digest_size=_VERSION_BYTES)
    for path in (*code, *(resources.folder("ontology") / name for name in _DATA)):
        digest.update(path.read_bytes())
    return int.from_bytes(digest.digest(), "little")
