"""Parts of a program that run at the same time and drive the same thing."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

from kg.errors import RobotError
from kg.robot.programs.tree import Do, OnEvent, Parallel
from kg.robot.programs.walk import sequences_of, statements

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.robot.capability import Capability
    from kg.robot.programs.names import Known
    from kg.robot.programs.tree import Statement

__all__ = ["collisions"]


def collisions(statement: Parallel | OnEvent, path: str, known: Known) -> Iterator[tuple[str, str, bool]]:
    """Yield where two parts drive one thing: the path of the later one, in words, and whether it is surely the same."""
    parts = [list(_driven(body, f"{path}/{part}", known)) for part, body in sequences_of(statement)]
    told = set()
    for earlier, later in combinations(parts, 2):
        for _, one in earlier:
            for where, other in later:
                same = one.name == other.name or bool(_ends(one) & _ends(other))
                if (same or _moves(one, other)) and where not in told:
                    told.add(where)
                    both = f"`{one.label}`" if one.name == other.name else f"`{one.label}` and `{other.label}`"
                    what = "is" if one.name == other.name else "are"
                    yield where, f"{both} {what} done in two parts that run at the same time", same


def _driven(body: tuple[Statement, ...], path: str, known: Known) -> Iterator[tuple[str, Capability]]:
    for where, statement in statements(body, path):
        if isinstance(statement, Do):
            try:
                yield where, known.write(statement.capability)
            except RobotError:
                continue


def _ends(capability: Capability) -> set[tuple[str, str]]:
    return {(way.kind, way.name) for way in capability.ways}


def _moves(one: Capability, other: Capability) -> bool:
    return one.moves is not None and one.moves == other.moves
