"""Terms as integers: a term is interned by its spelling (`kg.store.terms`)."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Final, cast
from zlib import crc32

import numpy as np
from pyoxigraph import Triple

from kg.store.terms import Term, of_spelling, spell

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray


IRI, BLANK, LITERAL, TRIPLE = range(1, 5)
"""The kinds of terms; 0 is that of "unbound"."""

_KINDS = np.zeros(1 << 16, np.int8)
# The first two bytes of a spelling, as a little-endian number, to the kind; `<<` opens a triple term.
_KINDS[0x3C::0x100] = IRI
_KINDS[0x3C3C] = TRIPLE
_KINDS[0x5F::0x100] = BLANK
_KINDS[0x22::0x100] = LITERAL


_FEW: Final = 10_000
"""Where more kept terms than this are looked up one by one, all of them are read."""


@dataclass(frozen=True, slots=True)
class Kept:
    """The spellings of terms 1, 2, ... as they are in a file, to be read one by one."""

    text: memoryview
    """All spellings, without anything between them."""
    ends: NDArray[np.int64]
    """Where each begins, and where the last one ends."""
    sums: NDArray[np.uint32]
    """The CRC-32 of each, sorted."""
    order: NDArray[np.uint32]
    """For each of these its place among the terms, from 0."""

    @staticmethod
    def index(spellings: Sequence[bytes]) -> tuple[NDArray[np.int64], NDArray[np.uint32], NDArray[np.uint32]]:
        """Return `ends`, `sums` and `order` of distinct spellings."""
        ends = np.zeros(len(spellings) + 1, np.int64)
        np.cumsum(np.fromiter(map(len, spellings), np.int64, len(spellings)), out=ends[1:])
        sums = np.fromiter(map(crc32, spellings), np.uint32, len(spellings))
        order = np.argsort(sums, kind="stable").astype(np.uint32)
        return ends, sums[order], order

    def __len__(self) -> int:
        return self.order.size

    def spelling(self, identifier: int) -> bytes:
        """Return the spelling of a term."""
        return bytes(self.text[self.ends[identifier - 1] : self.ends[identifier]])

    def find(self, spelling: bytes) -> int | None:
        """Return the identifier of a term."""
        wanted = np.uint32(crc32(spelling))
        for place in range(self.sums.searchsorted(wanted), self.sums.searchsorted(wanted, "right")):
            identifier = int(self.order[place]) + 1
            if self.spelling(identifier) == spelling:
                return identifier
        return None

    def spellings(self) -> list[bytes]:
        """Return all of them."""
        text, ends = bytes(self.text), self.ends.tolist()
        return [text[begin:end] for begin, end in pairwise(ends)]


class _Identifiers(dict[bytes, int]):
    """Gives a spelling that it does not have the next identifier; looking up stays in C for those that it has."""

    def __init__(self, spellings: list[bytes | None], kept: Kept | None = None) -> None:
        super().__init__()
        self._spellings = spellings
        self._kept = kept
        self._asked = 0

    def __missing__(self, spelling: bytes) -> int:
        identifier = self.find(spelling)
        if identifier is None:
            identifier = len(self._spellings)
            self._spellings.append(spelling)
        self[spelling] = identifier
        return identifier

    def find(self, spelling: bytes) -> int | None:
        """Return the identifier of a spelling that is known."""
        found = self.get(spelling)
        if found is not None or self._kept is None:
            return found
        self._asked += 1
        if self._asked <= _FEW:
            return self._kept.find(spelling)
        every = self._kept.spellings()
        self._spellings[1 : len(every) + 1] = every
        self.update(zip(every, range(1, len(every) + 1), strict=True))
        self._kept = None
        return self.get(spelling)


class Dictionary:
    """Spellings to identifiers and back. Identifiers count from 1; 0 stands for "unbound"."""

    def __init__(self, kept: Kept | None = None) -> None:
        """With `kept`, its terms are known, and read on use."""
        self._kept = kept
        self._spellings: list[bytes | None] = [b"", *[None] * (len(kept) if kept else 0)]
        self._identifiers = _Identifiers(self._spellings, kept)
        self._kinds = np.zeros(1, np.int8)
        self._parts: dict[int, tuple[int, int, int]] = {}

    @classmethod
    def of(cls, spellings: Sequence[bytes]) -> Dictionary:
        """Return a dictionary of different terms, with identifiers in their order."""
        made = cls()
        made._spellings += spellings
        made._identifiers.update(zip(spellings, range(1, len(spellings) + 1), strict=True))
        return made

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
        return self._identifiers.find(spelling)

    def spelling(self, identifier: int) -> bytes:
        """Return how a term is spelt in N-Triples."""
        found = self._spellings[identifier]
        return self._read(identifier) if found is None else found

    def _read(self, identifier: int) -> bytes:
        assert self._kept is not None  # noqa: S101 - nothing else leaves a spelling out
        found = self._spellings[identifier] = self._kept.spelling(identifier)
        return found

    def spellings(self, identifiers: NDArray[np.int64] | Sequence[int]) -> list[bytes]:
        """Return the spellings of many terms, in their order."""
        every = self._spellings
        numbers = identifiers.tolist() if isinstance(identifiers, np.ndarray) else identifiers
        found = [every[identifier] for identifier in numbers]
        if self._kept is not None and None in found:
            return [self._read(number) if one is None else one for number, one in zip(numbers, found, strict=True)]
        return cast("list[bytes]", found)

    def term(self, identifier: int) -> Term:
        """Return a term as one of pyoxigraph's."""
        return of_spelling(self.spelling(identifier))

    def kinds(self, identifiers: NDArray[np.int64]) -> NDArray[np.int8]:
        """Return the kind of each term. Only spellings of terms new to this method are parsed."""
        if self._kinds.size < len(self._spellings):
            # Grown by more than needed, so terms created one by one do not copy it each time.
            grown = np.zeros(len(self._spellings) * 5 // 4, np.int8)
            grown[: self._kinds.size] = self._kinds
            self._kinds = grown
        found: NDArray[np.int8] = self._kinds[identifiers]
        if not found.all():
            missing = np.unique(identifiers[found == 0])
            beginnings = b"".join([spelling[:2] or b"\0\0" for spelling in self.spellings(missing)])
            self._kinds[missing] = _KINDS[np.frombuffer(beginnings, "<u2")]
            found = self._kinds[identifiers]
        return found

    def intern_triple(self, subject: int, predicate: int, value: int) -> int:
        """Return the identifier of the triple term of three terms."""
        found = self.intern(b"<<( %s %s %s )>>" % tuple(self.spellings((subject, predicate, value))))
        self._parts[found] = (subject, predicate, value)
        return found

    def parts(self, identifier: int) -> tuple[int, int, int]:
        """Return subject, predicate and object of a triple term; interns those that are not known."""
        found = self._parts.get(identifier)
        if found is None:
            triple = self.term(identifier)
            if not isinstance(triple, Triple):
                raise TypeError(self.spelling(identifier))
            found = (
                self.intern_term(triple.subject),
                self.intern_term(triple.predicate),
                self.intern_term(triple.object),
            )
            self._parts[identifier] = found
        return found
