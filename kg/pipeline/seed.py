"""The shipped ontologies as a generation of a store, from which the next new stores begin.

    ~/.cache/kg/ontologies/KEY

Loading them takes a third of a small build, copying a file a tenth of that. The file of the user's cache has the
database, and the triples as columns and as N-Triples. `KEY` is a digest of all that they depend on. A file that is
missing or damaged is written by the next build.
"""

from __future__ import annotations

from contextlib import suppress
from functools import lru_cache
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING, Final

import msgspec
import pyoxigraph

from kg import resources
from kg.store import cachefile
from kg.store.layout import user_cache

if TYPE_CHECKING:
    from pyoxigraph import NamedNode

_FOLDER: Final = "ontologies"
_VERSION: Final = 1
"""The number of the form of the file."""
_CODE: Final = ("graph/ontology_files.py", "store/bulk.py", "store/terms.py", "rules/written.py", "rules/engine")
"""The code that makes the content, below `kg`."""


class Seed(msgspec.Struct, frozen=True):
    """The ontologies in all forms that a new store needs.

    `files` are those of the closed database, `terms` the spellings of the identifiers from 1 on, `columns` the sorted
    pairs of each predicate as bytes, `packed` the compressed N-Triples.
    """

    files: dict[str, bytes]
    terms: list[bytes]
    columns: dict[int, bytes]
    packed: bytes


def key_of(ontologies: str, graph: NamedNode) -> str:
    """Return the key of the ontologies with a digest, in a graph."""
    parts = f"{ontologies} {graph} {pyoxigraph.__version__} {_code()}"
    return blake2b(parts.encode(), digest_size=16).hexdigest()


def load(key: str) -> Seed | None:
    """Return the seed with a key; None if there is none."""
    with suppress(OSError, RuntimeError, msgspec.MsgspecError):  # the home folder may be unknown
        content = cachefile.load(user_cache() / _FOLDER, key, _VERSION)
        return None if content is None else msgspec.msgpack.decode(content, type=Seed)
    return None


def save(key: str, seed: Seed) -> None:
    """Keep a seed instead of an earlier one, if the user's cache can be written."""
    with suppress(OSError, RuntimeError):
        cachefile.save(user_cache() / _FOLDER, key, _VERSION, [msgspec.msgpack.encode(seed)])


@lru_cache(maxsize=1)
def _code() -> str:
    """Return a digest of the code that makes the content."""
    package = Path(__file__).resolve().parent.parent
    return resources.digest(package / name for name in _CODE)
