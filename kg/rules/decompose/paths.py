"""Property paths in a normal form: a union of sequences of steps, and whether the path holds of length zero.

As relations between terms, paths obey the algebra of relations, with I the identity and a star the reflexive and
transitive closure. So each of these is exact where only the pairs matter, not how often they come:

    a/b with a = I + A, b = I + B    I + A + B + A/B
    ^(a/b)                           ^b/^a
    (I + A)+, (I + A)*               I + A+
    (A+)+                            A+
    a?                               I + a

A path's pairs of length zero are those of the terms of the graph, and of the constants at its ends
(SPARQL 1.1, section 18.4).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TypeAlias

from pyoxigraph import NamedNode

from kg.rules.form import Variable
from kg.syntax.tree import Alternative, Inverse, Negated, Path, Repeat, Sequence


@dataclass(frozen=True, slots=True)
class Link:
    """One triple with the predicate, read backwards with `inverse`."""

    predicate: NamedNode | Variable
    inverse: bool = False


@dataclass(frozen=True, slots=True)
class Avoid:
    """One triple with any predicate but these, read backwards with `inverse`."""

    predicates: tuple[NamedNode, ...]
    inverse: bool = False


@dataclass(frozen=True, slots=True)
class Closure:
    """One or more times one of the alternatives."""

    alternatives: tuple[Steps, ...]


Step: TypeAlias = Link | Avoid | Closure
Steps: TypeAlias = tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class Normal:
    """A union of sequences, each of at least one step, and of the identity when `zero`."""

    alternatives: tuple[Steps, ...]
    zero: bool = False


def normal(path: Path) -> Normal:
    """Return the normal form of a path."""
    if isinstance(path, NamedNode | Variable):
        return Normal(((Link(path),),))
    if isinstance(path, Inverse):
        inner = normal(path.path)
        return Normal(tuple(map(_backwards, inner.alternatives)), inner.zero)
    if isinstance(path, Alternative):
        parts = [normal(part) for part in path.parts]
        return _normal([steps for part in parts for steps in part.alternatives], zero=any(part.zero for part in parts))
    if isinstance(path, Sequence):
        return _sequence([normal(part) for part in path.parts])
    if isinstance(path, Repeat):
        return _repeat(normal(path.path), path)
    return _avoid(path)


def _normal(alternatives: list[Steps], *, zero: bool) -> Normal:
    return Normal(tuple(dict.fromkeys(alternatives)), zero)


def _sequence(parts: list[Normal]) -> Normal:
    choices = [(*part.alternatives, *([()] if part.zero else [])) for part in parts]
    alternatives: list[Steps] = [tuple(step for steps in chosen for step in steps) for chosen in product(*choices)]
    return _normal([steps for steps in alternatives if steps], zero=() in alternatives)


def _repeat(inner: Normal, path: Repeat) -> Normal:
    zero = inner.zero or path.least == 0
    if not path.many:
        return Normal(inner.alternatives, zero)
    flat: list[Steps] = []
    for steps in inner.alternatives:
        flat += steps[0].alternatives if len(steps) == 1 and isinstance(steps[0], Closure) else [steps]
    return Normal(((Closure(tuple(dict.fromkeys(flat))),),), zero) if flat else Normal((), zero)


def _avoid(path: Negated) -> Normal:
    alternatives: list[Steps] = []
    if path.forward or not path.backward:
        alternatives.append((Avoid(path.forward),))
    if path.backward:
        alternatives.append((Avoid(path.backward, inverse=True),))
    return Normal(tuple(alternatives))


def _backwards(steps: Steps) -> Steps:
    return tuple(inverse(step) for step in reversed(steps))


def inverse(step: Step) -> Step:
    """Return a step that goes the other way."""
    if isinstance(step, Link):
        return Link(step.predicate, not step.inverse)
    if isinstance(step, Avoid):
        return Avoid(step.predicates, not step.inverse)
    return Closure(tuple(map(_backwards, step.alternatives)))


def is_plain(path: Path) -> bool:
    """Return whether a path gives its pairs as often as the joins of its normal form do: no choice, no repetition."""
    if isinstance(path, Sequence):
        return all(map(is_plain, path.parts))
    if isinstance(path, Inverse):
        return is_plain(path.path)
    return isinstance(path, NamedNode | Variable)


def key(steps: Steps) -> str:
    """Return steps as text, equal for equal steps."""
    return "/".join(map(_step_key, steps))


def _step_key(step: Step) -> str:
    if isinstance(step, Closure):
        return f"({'|'.join(sorted(map(key, step.alternatives)))})+"
    sign = "^" if step.inverse else ""
    if isinstance(step, Link):
        return f"{sign}{step.predicate}"
    return f"!({'|'.join(sorted(sign + str(predicate) for predicate in step.predicates))}){sign}"
