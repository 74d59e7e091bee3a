"""Terms as integers: a term is interned by its spelling (`kg.store.terms`)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final
from zlib import crc32

import numpy as np
from pyoxigraph import Triple

from kg.rules.engine.facts import distinct
from kg.store.terms import Term, of_spelling, spell

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from kg.rules.engine.pages import Pages


IRI, BLANK, LITERAL, TRIPLE = range(1, 5)
"""The kinds of terms; 0 is that of "unbound"."""

_KINDS = np.zeros(1 << 16, np.int8)
# The first two bytes of a spelling, as a little-endian number, to the kind; `<<` opens a triple term.
_KINDS[0x3C::0x100] = IRI
_KINDS[0x3C3C] = TRIPLE
_KINDS[0x5F::0x100] = BLANK
_KINDS[0x22::0x100] = LITERAL


_RECENT: Final = 1 << 14
"""So many terms are held in memory, where there is a file for the others."""


@dataclass(frozen=True, slots=True)
class Spellings:
    """The spellings of some terms as they are in a file, to be read one by one; their places count from 0."""

    text: memoryview
    """All spellings, without anything between them."""
    ends: NDArray[np.int64]
    """Where each begins, and where the last one ends."""
    sums: NDArray[np.uint32]
    """The CRC-32 of each, sorted."""
    order: NDArray[np.uint32]
    """For each of these its place among the terms."""

    @classmethod
    def of(cls, spellings: Sequence[bytes]) -> Spellings:
        """Return distinct spellings."""
        ends = np.zeros(len(spellings) + 1, np.int64)
        np.cumsum(np.fromiter(map(len, spellings), np.int64, len(spellings)), out=ends[1:])
        sums = np.fromiter(map(crc32, spellings), np.uint32, len(spellings))
        order = np.argsort(sums, kind="stable").astype(np.uint32)
        return cls(memoryview(b"".join(spellings)), ends, sums[order], order)

    def within(self, pages: Pages) -> Spellings:
        """Return the same in a file."""
        text = pages.join([np.frombuffer(self.text, np.uint8)])
        return Spellings(text.data, pages.store(self.ends), pages.store(self.sums), pages.store(self.order))

    def and_then(self, other: Spellings, pages: Pages) -> Spellings:
        """Return these spellings, and those of `other` behind them, in a file."""
        text = pages.join([np.frombuffer(one.text, np.uint8) for one in (self, other)])
        ends = pages.join([self.ends, other.ends[1:] + self.ends[-1]])
        sums = np.concatenate([self.sums, other.sums])
        merged = np.argsort(sums, kind="stable")  # of two that are sorted, in one pass
        order = np.concatenate([self.order, other.order + np.uint32(len(self))])[merged]
        return Spellings(text.data, ends, pages.store(sums[merged]), pages.store(order))

    def __len__(self) -> int:
        return self.order.size

    def spelling(self, place: int) -> bytes:
        """Return one spelling."""
        return bytes(self.text[self.ends[place] : self.ends[place + 1]])

    def spellings(self, places: NDArray[np.int64]) -> list[bytes]:
        """Return many spellings."""
        text, begins, ends = self.text, self.ends[places].tolist(), self.ends[places + 1].tolist()
        return [bytes(text[begin:end]) for begin, end in zip(begins, ends, strict=True)]

    def beginnings(self, places: NDArray[np.int64]) -> NDArray[np.uint16]:
        """Return the first two bytes of some spellings, as little-endian numbers, without the rest."""
        text, begins = np.frombuffer(self.text, np.uint8), self.ends[places]
        pairs = np.stack([text[begins], text[begins + 1]], axis=1)
        return pairs.view("<u2").ravel()

    def find(self, spelling: bytes) -> int | None:
        """Return the place of a spelling."""
        wanted = np.uint32(crc32(spelling))
        for number in range(self.sums.searchsorted(wanted), self.sums.searchsorted(wanted, "right")):
            place = int(self.order[number])
            if self.spelling(place) == spelling:
                return place
        return None

    def find_all(self, spellings: Sequence[bytes], sums: NDArray[np.uint32]) -> NDArray[np.int64]:
        """Return the place of each spelling, -1 for those that are not there; `sums` are their CRC-32."""
        result = np.full(len(spellings), -1, np.int64)
        numbers = self.sums.searchsorted(sums)
        numbers[numbers == self.sums.size] = 0
        like = np.flatnonzero(self.sums[numbers] == sums)
        places = self.order[numbers[like]].astype(np.int64)
        for at, place, text in zip(like.tolist(), places.tolist(), self.spellings(places), strict=True):
            if text == spellings[at]:
                result[at] = place
            elif (other := self.find(spellings[at])) is not None:
                result[at] = other
        return result


class _Identifiers(dict[bytes, int]):
    """Gives a spelling that it does not have the next identifier; looking up stays in C for those that it has.

    It has those of `recent` terms, the first of which has the identifier `first`, and of others that were looked for,
    which are in files: `stored` are these, by identifier, each with its first one.
    """

    def __init__(self, stored: Spellings | None = None) -> None:
        super().__init__()
        self.stored = [(1, stored)] if stored else []
        self.first = 1 + len(stored) if stored else 0
        self.recent = [] if stored else [b""]

    def __missing__(self, spelling: bytes) -> int:
        identifier = self.find(spelling)
        if identifier is None:
            identifier = self.first + len(self.recent)
            self.recent.append(spelling)
        self[spelling] = identifier
        return identifier

    def find(self, spelling: bytes) -> int | None:
        """Return the identifier of a spelling that is known."""
        identifier = self.get(spelling)
        for first, part in self.stored if identifier is None else ():
            if (place := part.find(spelling)) is not None:
                return first + place
        return identifier

    def look_up(self, spellings: Iterable[bytes]) -> None:
        """Learn the identifiers of those spellings that are in files, all together."""
        unknown = [one for one in dict.fromkeys(spellings) if one not in self] if self.stored else []
        sums = np.fromiter(map(crc32, unknown), np.uint32, len(unknown))
        for first, part in self.stored:
            for one, place in zip(unknown, part.find_all(unknown, sums).tolist(), strict=True):
                if place >= 0:
                    self[one] = first + place

    def put_away(self, pages: Pages) -> None:
        """Write the recent terms to the file, and forget all. Of the parts there each is over twice the next."""
        if self.first == 0:
            self.first, self.recent = 1, self.recent[1:]
        if self.recent:
            first, last = self.first, Spellings.of(self.recent).within(pages)
            self.first, self.recent = first + len(last), []
            while self.stored and len(self.stored[-1][1]) <= 2 * len(last):
                first, before = self.stored.pop()
                last = before.and_then(last, pages)
            self.stored.append((first, last))
        self.clear()
        pages.release()


class Dictionary:
    """Spellings to identifiers and back. Identifiers count from 1; 0 stands for "unbound"."""

    def __init__(self, stored: Spellings | None = None, pages: Pages | None = None) -> None:
        """With `stored`, its terms are known, and read on use. With `pages`, only those met last stay in memory."""
        self.pages = pages
        self._identifiers = _Identifiers(stored)
        self._kinds = np.zeros(1, np.int8)
        self._parts: dict[int, tuple[int, int, int]] = {}

    @classmethod
    def of(cls, spellings: Sequence[bytes], pages: Pages | None = None) -> Dictionary:
        """Return a dictionary of different terms, with identifiers in their order; `pages` as of a new one."""
        dictionary = cls(pages=pages)
        dictionary._identifiers.recent += spellings
        dictionary._identifiers.update(zip(spellings, range(1, len(spellings) + 1), strict=True))
        return dictionary

    def __len__(self) -> int:
        return self._identifiers.first + len(self._identifiers.recent)

    def intern(self, spelling: bytes) -> int:
        """Return the identifier of a term, a new one when it is not known."""
        self._make_room()
        return self._identifiers[spelling]

    def intern_term(self, term: Term) -> int:
        """Return the identifier of a term of pyoxigraph."""
        return self.intern(spell(term))

    def intern_all(self, spellings: Iterable[bytes]) -> NDArray[np.int64]:
        """Return the identifiers of many terms, in their order."""
        self._make_room()
        if self._identifiers.stored:
            spellings = spellings if isinstance(spellings, list) else list(spellings)
            self._identifiers.look_up(spellings)
        return np.fromiter(map(self._identifiers.__getitem__, spellings), np.int64)

    def _make_room(self) -> None:
        if self.pages is not None and len(self._identifiers) > _RECENT:
            self._identifiers.put_away(self.pages)

    def find(self, spelling: bytes) -> int | None:
        """Return the identifier of a term that is known, without making one."""
        return self._identifiers.find(spelling)

    def spelling(self, identifier: int) -> bytes:
        """Return how a term is spelt in N-Triples."""
        return self.spellings((identifier,))[0]

    def spellings(self, identifiers: NDArray[np.int64] | Sequence[int]) -> list[bytes]:
        """Return the spellings of many terms, in their order."""
        terms = self._identifiers
        if not terms.stored:
            every = terms.recent
            numbers = identifiers.tolist() if isinstance(identifiers, np.ndarray) else identifiers
            return [every[identifier] for identifier in numbers]
        wanted = np.asarray(identifiers, np.int64)
        result = [b""] * wanted.size
        for first, part in terms.stored:
            places = np.flatnonzero((wanted >= first) & (wanted < first + len(part)))
            for at, spelling in zip(places.tolist(), part.spellings(wanted[places] - first), strict=True):
                result[at] = spelling
        for at in np.flatnonzero(wanted >= terms.first).tolist():
            result[at] = terms.recent[wanted[at] - terms.first]
        return result

    def whole(self) -> tuple[Spellings, list[memoryview]]:
        """Return all terms as they are to be written to a file: without a text, and the parts of the text."""
        terms = self._identifiers
        recent = Spellings.of(terms.recent if terms.stored else terms.recent[1:])
        every = [*(part for _, part in terms.stored), recent]
        begins = np.cumsum([0, *(part.ends[-1] for part in every)])
        ends = [part.ends[1:] + begin for part, begin in zip(every, begins, strict=False)]
        places = np.cumsum([0, *map(len, every)]).astype(np.uint32)
        sums = np.concatenate([part.sums for part in every])
        merged = np.argsort(sums, kind="stable")
        order = np.concatenate([part.order + first for part, first in zip(every, places, strict=False)])
        whole = Spellings(memoryview(b""), np.concatenate([[0], *ends]), sums[merged], order[merged])
        return whole, [part.text for part in every]

    def term(self, identifier: int) -> Term:
        """Return a term as one of pyoxigraph's."""
        return of_spelling(self.spelling(identifier))

    def kinds(self, identifiers: NDArray[np.int64]) -> NDArray[np.int8]:
        """Return the kind of each term. Only spellings of terms new to this method are parsed."""
        if self._kinds.size < len(self):
            # Grown by more than needed, so terms created one by one do not copy it each time.
            grown = np.zeros(len(self) * 5 // 4, np.int8)
            grown[: self._kinds.size] = self._kinds
            self._kinds = grown
        result: NDArray[np.int8] = self._kinds[identifiers]
        if not result.all():
            missing = distinct(identifiers[result == 0])
            self._kinds[missing] = _KINDS[self._beginnings(missing)]
            result = self._kinds[identifiers]
        return result

    def may_have_blanks(self, identifiers: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Return whether each term is a blank node, or a triple term that may have one in it: False is certain."""
        kinds = self.kinds(identifiers)
        result: NDArray[np.bool_] = kinds == BLANK
        triples = np.flatnonzero(kinds == TRIPLE)
        result[triples] = [b"_:" in spelling for spelling in self.spellings(identifiers[triples])]
        return result

    def _beginnings(self, identifiers: NDArray[np.int64]) -> NDArray[np.uint16]:
        """Return the first two bytes of the spelling of each term, as a little-endian number."""
        terms = self._identifiers
        result = np.zeros(identifiers.size, np.uint16)
        for first, part in terms.stored:
            places = np.flatnonzero((identifiers >= first) & (identifiers < first + len(part)))
            if places.size:
                result[places] = part.beginnings(identifiers[places] - first)
        places = np.flatnonzero(identifiers >= terms.first)
        numbers = (identifiers[places] - terms.first).tolist()
        text = b"".join([terms.recent[number][:2] or b"\0\0" for number in numbers])
        result[places] = np.frombuffer(text, "<u2")
        return result

    def intern_triple(self, subject: int, predicate: int, value: int) -> int:
        """Return the identifier of the triple term of three terms."""
        identifier = self.intern(b"<<( %s %s %s )>>" % tuple(self.spellings((subject, predicate, value))))
        self._parts[identifier] = (subject, predicate, value)
        return identifier

    def parts(self, identifier: int) -> tuple[int, int, int]:
        """Return subject, predicate and object of a triple term; interns those that are not known."""
        result = self._parts.get(identifier)
        if result is None:
            triple = self.term(identifier)
            if not isinstance(triple, Triple):
                raise TypeError(self.spelling(identifier))
            result = (
                self.intern_term(triple.subject),
                self.intern_term(triple.predicate),
                self.intern_term(triple.object),
            )
            self._parts[identifier] = result
        return result
