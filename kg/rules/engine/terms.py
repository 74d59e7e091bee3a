"""Terms as integers: a term is interned by its N-Triples spelling, as the store's engine writes it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from pyoxigraph import NamedNode

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from kg.rules.form import Term

__all__ = ["MAX_TERMS", "Dictionary", "spell"]

MAX_TERMS = 1 << 31
"""Two identifiers share one signed integer of 64 bits."""


class _Identifiers(dict[bytes, int]):
    """Gives a spelling that it does not have the next identifier; looking up stays in C for those that it has."""

    def __init__(self, spellings: list[bytes]) -> None:
        super().__init__()
        self._spellings = spellings

    def __missing__(self, spelling: bytes) -> int:
        identifier = self[spelling] = len(self._spellings)
        self._spellings.append(spelling)
        return identifier


class Dictionary:
    """Spellings to identifiers and back. Identifiers count from 1; 0 stands for "unbound"."""

    def __init__(self) -> None:
        self._spellings: list[bytes] = [b""]
        self._identifiers = _Identifiers(self._spellings)

    def __len__(self) -> int:
        return len(self._spellings)

    def intern(self, spelling: bytes) -> int:
        """Return the identifier of a term, a new one when it is not known."""
        return self._identifiers[spelling]

    def intern_term(self, term: Term) -> int:
        """Return the identifier of a term of pyoxigraph."""
        return self._identifiers[spell(term)]

    def intern_all(self, spellings: Iterable[bytes]) -> NDArray[np.int64]:
        """Return the identifiers of many terms, in their order."""
        return np.fromiter(map(self._identifiers.__getitem__, spellings), np.int64)

    def find(self, spelling: bytes) -> int | None:
        """Return the identifier of a term that is known, without making one."""
        return self._identifiers.get(spelling)

    def spelling(self, identifier: int) -> bytes:
        """Return how a term is spelt in N-Triples."""
        return self._spellings[identifier]

    def spellings(self, identifiers: NDArray[np.int64] | Sequence[int]) -> list[bytes]:
        """Return the spellings of many terms, in their order."""
        every = self._spellings
        found = identifiers.tolist() if isinstance(identifiers, np.ndarray) else identifiers
        return [every[identifier] for identifier in found]


def spell(term: Term) -> bytes:
    """Return the N-Triples spelling of a term of pyoxigraph, the same that a dump of the store has."""
    return b"<" + term.value.encode() + b">" if isinstance(term, NamedNode) else str(term).encode()
