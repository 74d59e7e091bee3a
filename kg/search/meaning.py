"""How like a need each node is in meaning: cosines of sentence embeddings, kept in the store's cache.

The vectors of a model are one file, `.kg/cache/search/vectors/{identity of the model}`: a checksum, the digests of
the texts, and the vectors in half precision. A text whose digest is there is not embedded again.
"""

from __future__ import annotations

import io
import zlib
from contextlib import suppress
from hashlib import blake2b
from typing import TYPE_CHECKING, Final

import numpy as np

from kg.search.folding import bare_name
from kg.search.words import words
from kg.store.layout import write_atomically

if TYPE_CHECKING:
    from pathlib import Path

    from kg.search.documents import Document, PackageDocument
    from kg.search.encoding import Encoder
    from kg.search.index import Floats, Index

__all__ = ["Meaning", "told"]

_FOLDER: Final = ("search", "vectors")
_CHECKSUM_BYTES: Final = 4
_DIGEST_BYTES: Final = 16
_TEXTS: Final = 3
_LONGEST: Final = 1000
"""So many characters of a node are embedded; common models read 256 tokens."""


class Meaning:
    """The texts of an index as a model understands them."""

    def __init__(self, cache: Path, index: Index, encoder: Encoder) -> None:
        self._file = cache.joinpath(*_FOLDER, encoder.identity)
        self._index, self._encoder = index, encoder
        self._vectors: Floats | None = None

    def likeness(self, text: str) -> Floats:
        """Return the cosine of a text to each node, in the order of the index.

        Raises:
            UsageError: KG704 when the model cannot be used.
        """
        if self._vectors is None:
            self._vectors = self._embedded()
        if not self._index.size:
            return np.zeros(0, np.float32)
        found: Floats = self._vectors @ self._encoder.encode([text])[0]
        return found

    def unknown(self) -> int:
        """Return how many texts the next search has to embed first."""
        return 0 if self._vectors is not None else len(set(map(_digest, self._texts())) - set(_read(self._file)))

    def _texts(self) -> list[str]:
        nodes = map(self._index.nodes.__getitem__, range(self._index.size))
        return [told(node, self._index.packages[node.package]) for node in nodes]

    def _embedded(self) -> Floats:
        """Return the vectors of all nodes, those that are kept and those that are new."""
        of_nodes = self._texts()
        texts = {text: _digest(text) for text in of_nodes}
        kept = _read(self._file)
        new = [text for text, digest in texts.items() if digest not in kept]
        if new:
            vectors = self._encoder.encode(new).astype(np.float16)
            kept |= dict(zip(map(_digest, new), vectors, strict=True))
            # Vectors that cannot be kept are made again the next time, in a store that one may only read.
            with suppress(OSError):
                _write(self._file, {digest: kept[digest] for digest in texts.values()})
        return np.array([kept[texts[text]] for text in of_nodes], np.float32)


def told(node: Document, package: PackageDocument) -> str:
    """Return the text of a node for a model: its name and its package's in words, descriptions of both."""
    names = f"{bare_name(node.name)}, {' '.join(words(package.name))}"
    texts = [text.text for text in node.texts[:_TEXTS]]
    parts = [names, *texts, *([package.description] if package.description else [])]
    return ". ".join(" ".join(part.split()).rstrip(".") for part in parts)[:_LONGEST]


def _digest(text: str) -> bytes:
    return blake2b(text.encode(errors="replace"), digest_size=_DIGEST_BYTES).digest()


def _read(file: Path) -> dict[bytes, Floats]:
    """Return the vectors by the digests of their texts; none from a file that is damaged or not there."""
    try:
        content = file.read_bytes()
    except OSError:
        return {}
    body = content[_CHECKSUM_BYTES:]
    if zlib.crc32(body).to_bytes(_CHECKSUM_BYTES, "little") != content[:_CHECKSUM_BYTES]:
        return {}
    parts = io.BytesIO(body)
    digests, vectors = (np.load(parts, allow_pickle=False) for _ in range(2))
    return {digest.tobytes(): vector for digest, vector in zip(digests, vectors, strict=True)}


def _write(file: Path, vectors: dict[bytes, Floats]) -> None:
    """Write the vectors of a model, and remove those of others."""
    parts = io.BytesIO()
    np.save(parts, np.frombuffer(b"".join(vectors), np.uint8).reshape(-1, _DIGEST_BYTES), allow_pickle=False)
    np.save(parts, np.array(list(vectors.values()), np.float16), allow_pickle=False)
    body = parts.getvalue()
    file.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(file, zlib.crc32(body).to_bytes(_CHECKSUM_BYTES, "little") + body, durable=False)
    for path in file.parent.iterdir():
        if path != file and not path.name.endswith(".tmp"):
            with suppress(OSError):
                path.unlink()
