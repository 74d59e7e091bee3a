"""Numbers of values: sh:minCount, sh:maxCount and their qualified forms."""

from __future__ import annotations

from itertools import combinations, product
from typing import TYPE_CHECKING, Final

from pyoxigraph import Literal

from kg.rules.notations.shacl.logic import FALSE, TRUE, Cases, every

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kg.rules.form import Term
    from kg.rules.notations.shacl.graph import ShapesGraph
    from kg.rules.notations.shacl.paths import Branch, Names

__all__ = ["at_least", "number_of"]

_FEW: Final = 4
"""Up to here, different values are written out; more are counted by a sub-SELECT."""


def number_of(graph: ShapesGraph, shape: Term, name: str, value: Term) -> int:
    """Return the number of a constraint; KG201 if it is not a number, or if the shape has no path."""
    if not isinstance(value, Literal) or not value.value.isdecimal():
        raise graph.error(f"sh:{name} of {graph.called(shape)} is {value}", shape, hint="It is a whole number.")
    graph.required(shape, "path")
    return int(value.value)


def at_least(
    reach: Callable[[], list[Branch]], term: str, number: int, names: Names, extra: Callable[[str], Cases] | None
) -> Cases:
    """Return that a term reaches `number` different values that have one of the cases of `extra`.

    Each case is one filter with EXISTS (or tests of the term alone), so that its negation is to put NOT before it.
    """
    if number == 0:
        return TRUE
    first = reach()
    if number > _FEW and term.startswith("?") and all(branch.matched for branch in first):
        return [[_counted(first, term, number, names, extra)]]
    found: Cases = []
    for chosen in product(*(reach() for _ in range(number))):
        pattern = " ".join(branch.pattern for branch in chosen if branch.pattern)
        different = [f"FILTER(!sameTerm({one.term}, {two.term}))" for one, two in combinations(chosen, 2)]
        tests = every(extra(branch.term) for branch in chosen) if extra else TRUE
        if len({branch.term for branch in chosen}) == number:
            found += [[f"FILTER EXISTS {{ {' '.join([pattern, *different, *test])} }}"] for test in tests]
    return found or FALSE


def _counted(
    first: Sequence[Branch], term: str, number: int, names: Names, extra: Callable[[str], Cases] | None
) -> str:
    value = names.fresh()
    groups = []
    for branch in first:
        given = branch.giving(value)
        pattern = given.pattern if given else branch.pattern
        groups += [" ".join([pattern, *test]) for test in (extra(value) if extra else TRUE)]
    union = groups[0] if len(groups) == 1 else " UNION ".join(f"{{ {group} }}" for group in groups)
    having = f"HAVING(COUNT(DISTINCT {value}) >= {number})"
    return f"FILTER EXISTS {{ {{ SELECT {term} WHERE {{ {union} }} GROUP BY {term} {having} }} }}"
