"""Rules of equality mixed with others, and small graphs with equal terms, for property tests."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from hypothesis import strategies as st
from pyoxigraph import BlankNode, Literal, NamedNode, Triple
from rules.forms import test as kept_if

from kg.errors import Place
from kg.rules.form import Atom, Exists, Rule, Variable

if TYPE_CHECKING:
    from rules.engine.oracle import Fact

    from kg.rules.form import Element, Pattern, Term

__all__ = ["EQUAL", "RULES", "equal_facts", "equal_rules"]

EQUAL: Final = NamedNode("urn:equal")
_ALIKE: Final = NamedNode("urn:alike")
_P, _Q, _R, _DIFFERENT = (NamedNode(f"urn:{name}") for name in ("p", "q", "r", "different"))
_TERMS: Final = [NamedNode(f"urn:n{number}") for number in range(5)]
_VALUES: Final[list[Term]] = [Literal("x"), Literal(1), Triple(_TERMS[0], _P, _TERMS[1])]
_X, _Y, _Z, _S, _O = (Variable(name) for name in "xyzso")
_ANY: Final = Variable("any")


def _rule(name: str, head: tuple[Pattern, Pattern, Pattern], *body: Element) -> Rule:
    return Rule(f"test/{name}", (Atom(*head),), body, Place("r.rq"))


def _equality(equal: NamedNode) -> dict[str, Rule]:
    """Return the rules of an equality, with their atoms in either order."""
    same = Atom(_X, equal, _Y)
    name = equal.value.removeprefix("urn:")
    return {
        "symmetry": _rule(f"{name}-symmetry", (_Y, equal, _X), same),
        "transitivity": _rule(f"{name}-transitivity", (_X, equal, _Z), Atom(_Y, equal, _Z), same),
        "subject": _rule(f"{name}-subject", (_Y, _ANY, _O), same, Atom(_X, _ANY, _O)),
        "predicate": _rule(f"{name}-predicate", (_S, _Y, _O), Atom(_S, _X, _O), same),
        "object": _rule(f"{name}-object", (_S, _ANY, _Y), same, Atom(_S, _ANY, _X)),
    }


RULES: Final = _equality(EQUAL)
_LIKENESS: Final = _equality(_ALIKE)
_OTHERS: Final = [
    _rule("functional", (_X, EQUAL, _Y), Atom(_S, _P, _X), Atom(_S, _P, _Y)),
    _rule("reflexive", (_S, EQUAL, _S), Atom(_S, _ANY, _O)),
    _rule("contradiction", (_X, _R, _TERMS[0]), Atom(_X, EQUAL, _Y), Atom(_X, _DIFFERENT, _Y)),
    _rule("other", (_X, _Q, _Y), Atom(_X, EQUAL, _Y), kept_if("?x != ?y && ?x != <urn:n1>")),
    _rule("inverse", (_Y, _Q, _X), Atom(_X, _P, _Y)),
    _rule("chain", (_X, _P, _Z), Atom(_X, _P, _Y), Atom(_Y, _Q, _Z)),
    _rule("alike", (_X, _ALIKE, _Y), Atom(_X, _Q, _Y)),
    _rule("asserted", (_X, _R, _Y), Atom(_X, EQUAL, _Y, asserted=True)),
    _rule("reversed", (_X, _ANY, _O), Atom(_X, EQUAL, _Y), Atom(_Y, _ANY, _O)),
]
_ABOVE: Final = _rule(
    "alone", (_X, _R, _X), Atom(_X, _P, _Y), Exists((Atom(_Y, EQUAL, _Z), kept_if("?y != ?z")), negated=True)
)


@st.composite
def equal_rules(draw: st.DrawFn) -> list[Rule]:
    """Draw an equality with some of its rules, sometimes a second one, and rules that read and derive its terms.

    Without a rule that replaces predicates a rule that denies may be above.
    """
    replacing = draw(st.sets(st.sampled_from(["subject", "predicate", "object"])))
    found = [RULES["symmetry"], RULES["transitivity"], *(RULES[name] for name in sorted(replacing))]
    if draw(st.integers(0, 3)) == 0:
        names = draw(st.sets(st.sampled_from(sorted(_LIKENESS)), min_size=1))
        found += [_LIKENESS[name] for name in sorted({*names, "symmetry", "transitivity"})]
    found += draw(st.lists(st.sampled_from(_OTHERS), max_size=3, unique_by=lambda rule: rule.name))
    if not any(atom.predicate == _ANY for rule in found for atom in rule.head) and "predicate" not in replacing:
        found.append(_ABOVE)
    return list(draw(st.permutations(found)))


def equal_facts(least: int, most: int) -> st.SearchStrategy[set[Fact]]:
    """Yield triples, half of which make terms equal, including predicates, blank nodes and literals."""
    subjects = st.sampled_from([*_TERMS, *_TERMS, BlankNode("b"), _P, EQUAL])
    objects = st.sampled_from([*_TERMS, *_TERMS, *_VALUES, BlankNode("b"), _P, _Q, _ALIKE])
    same = st.tuples(subjects, st.just(EQUAL), objects)
    others = st.tuples(subjects, st.sampled_from([_P, _P, _Q, _DIFFERENT, _ALIKE]), objects)
    return st.sets(st.one_of(same, others), min_size=least, max_size=most)
