"""Table 9: the graph against the code. Are calls in the code in the graph, and do lines hold what facts say of them?

Calls come from a reader of their own (`kg.evaluate.call_sites`), facts from the graph. Both are sampled by kind, each
kind as often as any other, and the last row weighs kinds with how many there are.
"""

from __future__ import annotations

import os
import random
import re
from collections import Counter, defaultdict
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Final

from kg.corpus.reading import digest
from kg.evaluate.call_sites import CPP, KINDS, PYTHON, line_end, sites
from kg.evaluate.completeness import share
from kg.evaluate.facts import STATED, Facts
from kg.evaluate.paper import beside
from kg.evaluate.places import Places
from kg.evaluate.sheet import drawn
from kg.evaluate.strata import shares_of, weighed
from kg.evaluate.tables import Share, Table

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kg.evaluate.call_sites import Site
    from kg.evaluate.facts import Fact
    from kg.evaluate.source_lines import SourceLines
    from kg.evaluate.tables import Cell
    from kg.store.interface import Snapshot

_CALLS: Final = "calls that the graph has"
_FACTS: Final = "facts that their line holds"
_ALL: Final = "all, weighed by number"
_LARGEST: Final = 4_000_000
_TEST: Final = re.compile(
    r"(?:^|/)(?:[gm]?tests?|[^/]*_tests?|gtest[^/]*)/|(?:^|/)(?:test_[^/]*|[^/]*_?[tT]ests?)\.\w+$"
)
"""Paths of files of tests."""


@dataclass(frozen=True, slots=True)
class Miss:
    """A call that the graph has not, or a fact whose line does not hold it."""

    measure: str
    kind: str
    address: str
    text: str


@dataclass(frozen=True, slots=True)
class Checked:
    """The table, and what was missed."""

    table: Table
    missed: tuple[Miss, ...]


@dataclass(slots=True)
class _Found:
    """The calls of all files by kind, as pairs of a file and a call, and files that could not be compared."""

    calls: defaultdict[str, list[tuple[tuple[str, str], Site]]] = field(default_factory=lambda: defaultdict(list))
    left_out: Counter[str] = field(default_factory=Counter)
    files: int = 0


def check_code(snapshot: Snapshot, lines: SourceLines, size: int, seed: int, *, tests: bool = False) -> Checked:
    """Return how a sample of `size` calls and one of `size` facts fare; the same for the same store, code and seed.

    Files of tests are searched for calls with `tests` alone: a test's body is mostly no part of a node.
    """
    places = Places(snapshot)
    found = _calls(places, lines, tests=tests)
    rows: list[tuple[Cell, ...]] = []
    missed: list[Miss] = []
    chance = random.Random(seed)  # noqa: S311 - no secret
    numbers = shares_of({kind: len(found.calls[kind]) for kind in KINDS}, size)
    drawn_calls = [(kind, call) for kind in KINDS for call in chance.sample(found.calls[kind], numbers[kind])]
    known = [(kind, places.has(kind, file, site.first, site.last)) for kind, (file, site) in drawn_calls]
    rows += _rows(_CALLS, known, {kind: len(calls) for kind, calls in found.calls.items()})
    for (kind, (file, site)), (_, has_it) in zip(drawn_calls, known, strict=True):
        if not has_it:
            missed.append(_miss(_CALLS, kind, lines, (*file, site.line)))
    facts = Facts(snapshot)
    judged, absent = _facts(facts, lines, size, seed)
    rows += _rows(_FACTS, [(fact.relation, right) for fact, right in judged], _sizes(facts))
    missed += (
        _miss(_FACTS, fact.relation, lines, (fact.file_repository, fact.path, fact.line))
        for fact, right in judged
        if not right
    )
    notes = _notes(found, absent)
    table = Table("code", "The graph against the code", ("measure", "kind", "share", "number"), tuple(rows), notes)
    return Checked(beside(table, ("measure", "kind")), tuple(missed))


def _sizes(facts: Facts) -> dict[str, int]:
    return {relation: len(facts.listed.get(relation, ())) for relation in STATED}


def _rows(measure: str, judged: Iterable[tuple[str, bool]], sizes: Mapping[str, int]) -> Iterator[tuple[Cell, ...]]:
    counts: dict[str, list[int]] = {kind: [0, 0] for kind in KINDS}
    for kind, is_right in judged:
        counts[kind][0] += is_right
        counts[kind][1] += 1
    for kind, (right, looked) in counts.items():
        if looked:
            yield measure, kind, share(right, looked), sizes.get(kind, 0)
    every = weighed((sizes.get(kind, 0), looked, right) for kind, (right, looked) in counts.items() if looked)
    yield measure, _ALL, every or Share(0, 0), sum(sizes.values())


def _miss(measure: str, kind: str, lines: SourceLines, place: tuple[str, str, int]) -> Miss:
    return Miss(measure, kind, lines.address(*place), lines.text(*place) or "")


def _notes(found: _Found, absent: int) -> tuple[str, ...]:
    told = [f"{found.files:,} files of C++ and Python were searched for calls."]
    if found.left_out:
        told.append(f"Left out: {'; '.join(f'{number:,} {why}' for why, number in found.left_out.most_common())}.")
    if absent:
        told.append(f"{absent:,} sampled facts are in files that are missing or have changed.")
    return tuple(told)


def _calls(places: Places, lines: SourceLines, *, tests: bool) -> _Found:
    """Search the files of C++ and Python in the packages of the store, where they stand as they were read."""
    found = _Found()
    for repository in sorted(lines.states):
        root = lines.root(repository)
        if root is None:
            found.left_out["sources that are not on this machine"] += 1
            continue
        folders = places.folders(repository)
        for path in _files(root):
            if folders.isdisjoint([*map(str, PurePosixPath(path).parents)]):
                continue
            if not tests and _TEST.search(path):
                found.left_out["files of tests"] += 1
                continue
            _search(repository, root, path, places, found)
    return found


def _search(repository: str, root: Path, path: str, places: Places, found: _Found) -> None:
    try:
        data = (root / path).read_bytes()
    except OSError:
        found.left_out["files that cannot be read"] += 1
        return
    if places.digest(repository, path) not in {None, digest(data)}:
        found.left_out["files that were changed since"] += 1
        return
    found.files += 1
    for site in sites(data.decode("utf-8", "replace"), _language(path)):
        found.calls[site.kind].append(((repository, path), site))


def _language(path: str) -> str:
    return "python" if PurePosixPath(path).suffix.lower() in PYTHON else "cpp"


def _files(root: Path) -> Iterator[str]:
    """Yield the paths of the files of C++ and Python below a folder, sorted; folders with a dot are left out."""
    for folder, inner, names in os.walk(root):
        inner[:] = sorted(name for name in inner if not name.startswith("."))
        for name in sorted(names):
            path = Path(folder, name)
            if path.suffix.lower() in CPP | PYTHON and path.is_file() and path.stat().st_size <= _LARGEST:
                yield path.relative_to(root).as_posix()


def _facts(facts: Facts, lines: SourceLines, size: int, seed: int) -> tuple[list[tuple[Fact, bool]], int]:
    """Return sampled facts with whether their lines hold them, and how many of the sample have no line here."""
    judged, absent = [], 0
    for relation, pair in drawn(facts, tuple(STATED), size, seed):
        fact = _at_call(facts.told(relation, pair))
        text = lines.lines(fact.file_repository, fact.path)
        if text is None or not 0 < fact.line <= len(text):
            absent += 1
        else:
            judged.append((fact, holds(fact, text)))
    return judged, absent


def _at_call(fact: Fact) -> Fact:
    """Return a fact at the line that calls the framework, where that is in another package than the node."""
    if fact.call is None:
        return fact
    source = fact.call.repository or fact.repository
    return replace(fact, file_repository=source, path=fact.call.path, line=fact.call.line)


_WORDS: Final = {
    "publishes": r"advertise|ublish",
    "subscribes": r"ubscri|Filter",
    "provides": r"ervice|advertise|[sS]rv|Server",
    "calls": r"lient|ervice|[sS]rv|Proxy",
    "serves action": r"ction|[sS]erver|^\s*[:,]?\s*\w+_\s*[({]",
    "calls action": r"ction|lient|^\s*[:,]?\s*\w+_\s*[({]",
    "has parameter": r"",
}
_MOST: Final = 12
"""Lines of the longest statement."""
_BLANKS: Final = re.compile(r"\s+")
_SEGMENTS: Final = re.compile(r"[/.~]|\{[^}]*\}")


def holds(fact: Fact, lines: list[str]) -> bool:
    """Tell whether the statement that begins on a fact's line has its call, and its name or written expression.

    Of a name the last part counts, for namespaces and prefixes stand elsewhere. Files that are no code (of
    parameters, of dynamic reconfigure) need to have the name alone.
    """
    text = "\n".join(lines[fact.line - 1 : fact.line - 1 + _MOST])
    statement = text[: line_end(text) + 1]
    is_code = PurePosixPath(fact.path).suffix.lower() in CPP | PYTHON
    called = not is_code or re.search(_WORDS[fact.relation], statement) is not None
    return called and _named(fact, statement)


def _named(fact: Fact, statement: str) -> bool:
    if fact.written and _BLANKS.sub("", fact.written) in _BLANKS.sub("", statement):
        return True
    parts = [part for part in _SEGMENTS.split(fact.value or "") if part]
    return parts[-1] in statement if parts else not fact.written
