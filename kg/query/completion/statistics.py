"""Classes and properties of a store, which of them occur together, and how often.

All classes and properties are counted. The properties of a class come from a sample of its instances, the classes of a
property's values from a sample of the values. The engine orders terms by their hashes, so the first few hundred entries
of an index are a random sample. Numbers up to the size of the sample are exact; larger ones are estimates, rounded to
the significant digits. On five million quads this takes 6 s of processor time; counting all pairs of class and property
takes 21 s.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import shutil
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, Final, Protocol, TypeVar

import msgspec

from kg.store.layout import write_atomically
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from kg.store.interface import Snapshot


_Part = TypeVar("_Part")

SAMPLE: Final = 300
"""Number of sampled instances of a class."""
_VALUES: Final = 500
"""Number of sampled triples of a property, for the classes of its values."""
_DIGITS: Final = 2
_LONGEST: Final = 600
"""Largest length of a comment in characters; longer ones are cut."""


class Statistics(msgspec.Struct, frozen=True):
    """Statistics of the content of one snapshot.

    `classes` contains the number of instances of each class, `properties` the number of triples of each property.
    `used` maps a class and a property to the number of instances with it, `leads` a property and a class to the number
    of sampled values of that class. `literal` contains the properties with literals, `comments` the documentation of
    terms, and `prefixes` the prefixes that the store declares. IRIs are without brackets.
    """

    classes: dict[str, int] = {}
    properties: dict[str, int] = {}
    used: dict[str, dict[str, int]] = {}
    leads: dict[str, dict[str, int]] = {}
    literal: frozenset[str] = frozenset()
    comments: dict[str, str] = {}
    prefixes: dict[str, str] = {}


_CLASSES: Final = "SELECT ?c (COUNT(?s) AS ?n) { ?s a ?c FILTER(ISIRI(?c)) } GROUP BY ?c"
_PROPERTIES: Final = "SELECT ?p (COUNT(*) AS ?n) { ?s ?p ?o } GROUP BY ?p"
_USED: Final = """
SELECT ?p (COUNT(DISTINCT ?s) AS ?n) { { SELECT ?s { ?s a <%s> } LIMIT %d } ?s ?p ?o } GROUP BY ?p"""
_USERS: Final = "SELECT ?c (COUNT(DISTINCT ?s) AS ?n) { ?s <%s> ?o . ?s a ?c FILTER(ISIRI(?c)) } GROUP BY ?c"
_LEADS: Final = """
SELECT ?c (COUNT(DISTINCT ?o) AS ?n) {
  { SELECT ?o { ?s <%s> ?o } LIMIT %d } ?o a ?c FILTER(ISIRI(?c)) } GROUP BY ?c"""
_LITERAL: Final = "SELECT ?o { ?s <%s> ?o } LIMIT 1"
_COMMENTS: Final = """
SELECT ?t ?c { ?t rdfs:comment|skos:definition ?c . FILTER(ISIRI(?t) && (LANG(?c) = "" || LANGMATCHES(LANG(?c), "en")))
  { ?t a ?kind VALUES ?kind { rdfs:Class owl:Class rdf:Property owl:ObjectProperty owl:DatatypeProperty
    owl:AnnotationProperty owl:NamedIndividual skos:Concept } } }"""
_DECLARED: Final = """
SELECT ?prefix ?namespace { { ?x sh:prefix ?prefix ; sh:namespace ?namespace } UNION
  { ?namespace <http://purl.org/vocab/vann/preferredNamespacePrefix> ?prefix } } LIMIT 1000"""


class _Keep(Protocol):
    def __call__(self, key: str, make: Callable[[], _Part], kind: type[_Part], /) -> _Part: ...


def _without_cache(_key: str, make: Callable[[], _Part], _kind: type[_Part]) -> _Part:
    return make()


def count(snapshot: Snapshot, keep: _Keep = _without_cache) -> Statistics:
    """Return the statistics of a snapshot; takes some seconds for millions of quads.

    `keep` returns the cached result of a step, or computes it, so an interrupted count resumes where it stopped.
    """
    classes = keep("classes", lambda: dict(_numbers(snapshot, _CLASSES)), dict[str, int])
    properties = keep("properties", lambda: dict(_numbers(snapshot, _PROPERTIES)), dict[str, int])
    used = {each: _used(snapshot, each, number) for each, number in classes.items()}
    for each, number in properties.items():
        if number <= SAMPLE:
            # The samples of the classes may have missed rare properties.
            for kind, users in _numbers(snapshot, _USERS % each):
                used.setdefault(kind, {})[each] = users
    return Statistics(
        classes,
        properties,
        used,
        {each: dict(_numbers(snapshot, _LEADS % (each, _VALUES))) for each in properties if each != _TYPE},
        frozenset(each for each in properties if _is_literal(snapshot, each)),
        _comments(snapshot),
        declared(snapshot),
    )


def declared(snapshot: Snapshot) -> dict[str, str]:
    """Return the prefixes that the content of a snapshot declares, except the standard ones."""
    return {prefix: namespace for prefix, namespace in _texts(snapshot, _DECLARED) if prefix not in PREFIXES}


_TYPE: Final = PREFIXES["rdf"] + "type"


def _used(snapshot: Snapshot, kind: str, number: int) -> dict[str, int]:
    """Return the properties of a class, with the numbers of instances that have them."""
    numbers = dict(_numbers(snapshot, _USED % (kind, SAMPLE)))
    if number <= SAMPLE:
        return numbers
    # Estimates are rounded to their significant digits.
    estimates = {each: f"{seen * number / SAMPLE:.{_DIGITS - 1}e}" for each, seen in numbers.items()}
    return {each: number if seen == SAMPLE else int(float(estimates[each])) for each, seen in numbers.items()}


def _is_literal(snapshot: Snapshot, each: str) -> bool:
    rows: Any = snapshot.query(_LITERAL % each)
    return any(type(row[0]).__name__ == "Literal" for row in rows)


def _comments(snapshot: Snapshot) -> dict[str, str]:
    """Return the beginning of the documentation of each term, from its shortest comment."""
    comments: dict[str, str] = {}
    for term, comment in _texts(snapshot, _COMMENTS):
        shortest = comments.get(term)
        if shortest is None or (len(comment), comment) < (len(shortest), shortest):
            comments[term] = comment
    return {term: " ".join(comment.split())[:_LONGEST] for term, comment in sorted(comments.items())}


def _numbers(snapshot: Snapshot, query: str) -> Iterator[tuple[str, int]]:
    for name, number in _texts(snapshot, query):
        yield name, int(number)


def _texts(snapshot: Snapshot, query: str) -> Iterator[tuple[str, str]]:
    rows: Any = snapshot.query(query, prefixes=PREFIXES)
    return ((row[0].value, row[1].value) for row in rows)


_FORMAT: Final = 1
"""Version of the format of the files."""
_Content = TypeVar("_Content")


class SnapshotCache:
    """Cache entries of one snapshot in `folder`, or only in memory if `folder` is None."""

    def __init__(self, folder: Path | None, snapshot: Snapshot) -> None:
        self._snapshot = snapshot
        self._folder = None if folder is None else folder / f"completion-{_FORMAT}"
        self._own = None if self._folder is None else self._folder / snapshot.identity
        self._statistics: Statistics | None = None
        self._memory: dict[str, object] = {}
        self._objects: dict[str, object] = {}

    def over(self, snapshot: Snapshot) -> SnapshotCache:
        """Return this cache with another snapshot object of the same content."""
        self._snapshot = snapshot
        return self

    @property
    def snapshot(self) -> Snapshot:
        """Snapshot of the entries."""
        return self._snapshot

    def statistics(self, *, fresh: bool = False) -> Statistics:
        """Return the statistics of the snapshot.

        Without `fresh`, statistics of an earlier snapshot are returned if those of this one are not cached, and empty
        ones while another process counts for the first time.
        """
        if self._statistics is not None:
            return self._statistics
        path = None if self._own is None else self._own / "statistics.json"
        statistics = _read(path, Statistics)
        if statistics is None and not fresh and (earlier := self._earlier()) is not None:
            return earlier
        if statistics is None:
            with _locked(self._folder, wait=fresh) as is_locked:
                statistics = _read(path, Statistics)
                if statistics is None and not is_locked:
                    return Statistics()
                if statistics is None:
                    statistics = count(self._snapshot, self.values)
                    _write(path, statistics)
                    self._forget()
        self._statistics = statistics
        return statistics

    def cached_statistics(self) -> Statistics:
        """Return the cached statistics, of this snapshot or of an earlier one."""
        if self._statistics is None:
            path = None if self._own is None else self._own / "statistics.json"
            self._statistics = _read(path, Statistics)
        return self._statistics or self._earlier() or Statistics()

    def prefixes(self) -> dict[str, str]:
        """Return the prefixes that the store declares, except the standard ones."""
        return self.in_memory("prefixes", lambda: declared(self._snapshot))

    def values(self, key: str, make: Callable[[], _Content], kind: type[_Content]) -> _Content:
        """Return the cached value of `key`, or the result of `make`."""
        if key not in self._memory:
            name = hashlib.sha256(key.encode()).hexdigest()[:32] + ".json"
            path = None if self._own is None else self._own / name
            content = _read(path, kind)
            if content is None:
                content = make()
                _write(path, content)
            self._memory[key] = content
        return self._memory[key]  # type: ignore[return-value] # each key has contents of one kind

    def in_memory(self, key: str, make: Callable[[], _Content]) -> _Content:
        """Return the value of `key` cached in memory, or the result of `make`; never written to a file."""
        if key not in self._objects:
            self._objects[key] = make()
        return self._objects[key]  # type: ignore[return-value] # each key has contents of one kind

    def _earlier(self) -> Statistics | None:
        """Return the newest statistics of another snapshot."""
        if self._folder is None or not self._folder.is_dir():
            return None
        numbers = sorted((int(each.name) for each in self._folder.iterdir() if each.name.isdigit()), reverse=True)
        earlier = (_read(self._folder / str(number) / "statistics.json", Statistics) for number in numbers)
        return next((each for each in earlier if each is not None), None)

    def _forget(self) -> None:
        """Delete the entries of other snapshots."""
        if self._folder is not None and self._folder.is_dir():
            for each in self._folder.iterdir():
                if each.is_dir() and each.name.isdigit() and each != self._own:
                    shutil.rmtree(each, ignore_errors=True)


def _read(path: Path | None, kind: type[_Content]) -> _Content | None:
    if path is None:
        return None
    try:
        return msgspec.json.decode(path.read_bytes(), type=kind)
    except (OSError, msgspec.DecodeError):
        return None


def _write(path: Path | None, content: object) -> None:
    if path is None:
        return
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, msgspec.json.encode(content), durable=False)


@contextmanager
def _locked(folder: Path | None, *, wait: bool) -> Iterator[bool]:
    """Lock the right to count, which the system releases on exit; False if another process has it."""
    try:
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)
        handle = None if folder is None else os.open(folder / "lock", os.O_RDWR | os.O_CREAT)
    except OSError:
        handle = None
    if handle is None:
        yield True
        return
    try:
        fcntl.flock(handle, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)
        is_locked = True
    except BlockingIOError:
        is_locked = False
    try:
        yield is_locked
    finally:
        os.close(handle)
