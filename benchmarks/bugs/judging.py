"""What findings are worth: did the expected ones come, with the names, and only where the fault is."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bugs.facts import Bug

Finding = dict[str, Any]


@dataclass(frozen=True)
class Verdict:
    """What the rules made of one bug.

    `codes` are the expected ones that fired on the faulty commit with all names of a fault; `named` says how many of
    the faults were named; `silent` whether nothing of that is left on the mended commit; `further` are the other
    findings of the expected rules on the faulty commit.
    """

    bug: Bug
    codes: tuple[str, ...]
    named: int
    silent: bool
    further: tuple[Finding, ...]

    @property
    def found(self) -> bool:
        """Whether every fault was named, and the mended commit has none of it."""
        return self.named == len(self.bug.names) and self.silent


def judge(bug: Bug, faulty: Sequence[Finding], fixed: Sequence[Finding]) -> Verdict:
    """Compare the findings on both commits with what was expected."""
    hits = [[one for one in faulty if _tells(one, bug, names)] for names in bug.names]
    codes = {one["code"] for group in hits for one in group}
    right = [one for group in hits for one in group]
    return Verdict(
        bug,
        tuple(sorted(codes)),
        sum(map(bool, hits)),
        silent=not any(_tells(one, bug, names) for one in fixed for names in bug.names),
        further=tuple(one for one in faulty if one["code"] in bug.expect and one not in right),
    )


def _tells(finding: Finding, bug: Bug, names: Sequence[str]) -> bool:
    """Whether a finding is of an expected code and has all names, among its subjects or in its message."""
    words = {word.rstrip(".") for word in re.findall(r"[\w/~.]+", finding.get("message", ""))}
    return finding["code"] in bug.expect and set(names) <= words | set(finding.get("subjects", ()))
