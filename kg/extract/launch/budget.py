"""What one launch configuration may cost, since files that include each other can describe one without end."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.facts import StartedNode

__all__ = ["MOST", "Budget"]

MOST: Final = {
    "actions": 50_000,
    "bytes of files": 64 << 20,
    "elements": 200_000,
    "generated files": 1_000,
    "includes": 5_000,
    "nodes": 20_000,
    "parameters": 200_000,
    "places": 2_000_000,
    "substitutions": 500_000,
}
"""`places` are the lines that nodes, remappings and parameters are told with, and those of the includes before them."""
_PLACES_OF_A_REMAP: Final = 20


class Budget:
    """What one configuration has cost so far."""

    def __init__(self) -> None:
        self._spent: Counter[str] = Counter()

    def allows(self, report: Callable[[str], None], what: str, amount: int = 1) -> bool:
        """Count something and tell whether there may be so much of it; `report` is called the first time that not."""
        before, most = self._spent[what], MOST[what]
        self._spent[what] += amount
        if before <= most < self._spent[what]:
            report(f"the configuration has more than {most} {what}")
        return self._spent[what] <= most

    def allows_node(self, report: Callable[[str], None], node: StartedNode) -> bool:
        """Count a node with its remappings and parameters, and tell whether there may be so many."""
        chains = [node.chain, *(one.chain for one in node.remaps), *(one.chain for one in node.parameters)]
        places = len(chains) + sum(map(len, chains)) + _PLACES_OF_A_REMAP * len(node.remaps)
        return self.allows(report, "nodes") and self.allows(report, "places", places)
