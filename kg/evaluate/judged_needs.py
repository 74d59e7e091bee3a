"""Search needs with judged nodes, and the quality of a ranking: NDCG.

A line of a file of needs is an object: `id`, `query` (words), `constraints` (types that the node `subscribes` and
`publishes`, service types that it `provides` and `calls`), and `relevant`, the judged nodes: `repo` (owner/name),
`package`, `node`, `aliases`, `grade` (0 to 3).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import msgspec

from kg.errors import Place, UsageError
from kg.evaluate.references import owner_and_name, short_name

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

_HIGHEST: Final = 30
"""Maximum grade: higher gains exceed the range of floats."""


class Constraints(msgspec.Struct, frozen=True):
    """Required types of a node's interface, each `package/Type`."""

    subscribes: tuple[str, ...] = ()
    publishes: tuple[str, ...] = ()
    provides: tuple[str, ...] = ()
    calls: tuple[str, ...] = ()


class Judged(msgspec.Struct, frozen=True):
    """A node, and how well it meets a need: 3 is best, 0 not at all."""

    repo: str
    package: str
    node: str
    grade: int
    aliases: tuple[str, ...] | None = None


class Need(msgspec.Struct, frozen=True):
    """A query of a developer with its judgements."""

    id: str
    query: str
    relevant: tuple[Judged, ...]
    constraints: Constraints | None = None


class Ranked(msgspec.Struct, frozen=True):
    """A result of a search."""

    repository: str
    package: str
    node: str


def read_needs(path: Path) -> tuple[Need, ...]:
    """Return the needs in a file.

    Raises UsageError: KG725 the file is unreadable, empty, or has an invalid line.
    """
    try:
        lines = path.read_bytes().split(b"\n")
    except OSError as error:
        raise UsageError("KG725", f"the needs cannot be read: {error.strerror}", place=Place(str(path))) from None
    needs, decoder = [], msgspec.json.Decoder(Need)
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            need = decoder.decode(line)
        except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
            place = Place(str(path), number)
            raise UsageError("KG725", f"invalid need: {error}", place=place) from None
        if any(not 0 <= one.grade <= _HIGHEST for one in need.relevant):
            raise UsageError("KG725", f"a grade is not from 0 to {_HIGHEST}", place=Place(str(path), number))
        needs.append(need)
    if not needs:
        raise UsageError("KG725", "the file has no need", place=Place(str(path)))
    return tuple(needs)


def ndcg(need: Need, ranked: Sequence[Ranked], depth: int) -> float:
    """Return the normalised discounted cumulative gain of the first `depth` nodes, the gain of a grade 2^grade - 1.

    A node matches a judgement of its repository and package by its name or an alias. A judged node counts once, one
    that nobody judged has grade 0 (Järvelin and Kekäläinen 2002; gains of Burges et al. 2005).
    """
    best = _gain(sorted((one.grade for one in need.relevant), reverse=True)[:depth])
    return _gain(list(_grades(need, ranked[:depth]))) / best if best else 0.0


def _gain(grades: Sequence[int]) -> float:
    return math.fsum((2.0**grade - 1) / math.log2(place + 2) for place, grade in enumerate(grades))


def _grades(need: Need, ranked: Sequence[Ranked]) -> Iterator[int]:
    left = list(need.relevant)
    for one in ranked:
        hit = next((each for each in left if _same(each, one)), None)
        if hit is not None:
            left.remove(hit)
        yield hit.grade if hit is not None else 0


def _same(judged: Judged, ranked: Ranked) -> bool:
    names = {short_name(judged.node), *map(short_name, judged.aliases or ())}
    same_package = judged.package == ranked.package and owner_and_name(judged.repo) == owner_and_name(ranked.repository)
    return same_package and short_name(ranked.node) in names
