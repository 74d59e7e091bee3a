"""Meanings of typed names in a fact, compared with a plain search of all names, on random stores."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import Literal, NamedNode, Quad, Store

from kg.errors import KgError
from kg.query.naming import facts

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pyoxigraph import QueryBoolean, QuerySolutions, QueryTriples

BASE = "https://w3id.org/rnkg/"
USES = f"{BASE}ns#uses"
KIND = "http://www.w3.org/1999/02/22-rdf-syntax-ns#type"
LABEL = "http://www.w3.org/2000/01/rdf-schema#label"
THINGS = [BASE + end for end in ("one", "x/one", "y#one", "done", "two", "x/two", "y#two")]
LABELS = ("one", "two", "/one", "/two", "other")


class Snapshot:
    """A store with the query method of snapshots."""

    def __init__(self, triples: set[tuple[str, str, str]]) -> None:
        self.store = Store()
        self.texts: list[str] = []
        self.store.extend(
            Quad(NamedNode(one), NamedNode(two), Literal(three) if two == LABEL else NamedNode(three))
            for one, two, three in triples
        )

    def query(
        self, text: str, *, prefixes: Mapping[str, str] | None = None
    ) -> QuerySolutions | QueryBoolean | QueryTriples:
        """Run a query."""
        self.texts.append(text)
        return self.store.query(text, prefixes=dict(prefixes or {}))


def triples() -> st.SearchStrategy[set[tuple[str, str, str]]]:
    """Labels, kinds and uses of a few entities."""
    thing = st.sampled_from(THINGS)
    labels = st.tuples(thing, st.just(LABEL), st.sampled_from(LABELS))
    kinds = st.tuples(thing, st.just(KIND), st.sampled_from([BASE + "A", BASE + "B"]))
    uses = st.tuples(thing, st.just(USES), thing)
    return st.sets(st.one_of(labels, kinds, uses), max_size=16)


@settings(deadline=None, max_examples=300)
@given(triples())
def test_names_mean_what_a_search_of_all_names_finds(known: set[tuple[str, str, str]]) -> None:
    """Searching few names gives the same entities, or error, as searching all."""
    try:
        found, held = facts(Snapshot(known), "one", USES, "two")
        outcome: object = ({(fact.subject.value, fact.object.value) for fact in found}, held)  # type: ignore[union-attr]  # IRIs
    except KgError as error:
        outcome = error.code
    assert outcome == meaning(known)


def test_two_exact_names_are_not_searched_for() -> None:
    """No query reads all uses of a property, so the time does not grow with the store."""
    first, second, kind = THINGS[0], THINGS[4], BASE + "A"
    labels = {(first, LABEL, "one"), (second, LABEL, "two")}
    snapshot = Snapshot({*labels, (first, KIND, kind), (second, KIND, kind), (first, USES, first)})
    assert facts(snapshot, "one", USES, "two")[1] is False
    searching = [text for text in snapshot.texts if "STRENDS" in text]
    assert searching
    assert all("VALUES ?end" in text for text in searching)


def meaning(known: set[tuple[str, str, str]]) -> object:
    """Return the resolved facts and whether they hold, or the code of an error."""
    having = [[one for one in THINGS if {(one, LABEL, word), (one, LABEL, "/" + word)} & known] for word in WORDS]
    every = [
        ones + [one for one in THINGS if one not in ones and ends(one, word, known)]
        for ones, word in zip(having, WORDS, strict=True)
    ]
    uses = [(one, other) for one in every[0] for other in every[1] if (one, USES, other) in known]
    least = 1 if all(having) else 0
    for exact in (2, least):
        pairs = [pair for pair in uses if sum(one in ones for one, ones in zip(pair, having, strict=True)) >= exact]
        if pairs:
            named = {one for one, prop, label in known if prop == LABEL and label in WORDS}
            ranks = [(one not in named) + (other not in named) for one, other in pairs]
            return {pair for pair, rank in zip(pairs, ranks, strict=True) if rank == min(ranks)}, True
    if not all(every):
        return "KG001"
    used = [{one for one, prop, _ in known if prop == USES}, {other for _, prop, other in known if prop == USES}]
    if max(map(len, every)) > 1 and not used[0]:
        return "KG001"
    first = having if all(having) else every
    chosen = [choice(*each, known) for each in zip(first, every, WORDS, used, strict=True)]
    return ({(chosen[0][0], chosen[1][0])}, False) if list(map(len, chosen)) == [1, 1] else "KG003"


WORDS = ("one", "two")


def ends(thing: str, word: str, known: set[tuple[str, str, str]]) -> bool:
    """Whether an entity with a label has an IRI that ends in a word."""
    return thing.endswith(("/" + word, "#" + word)) and any(one == thing and prop == LABEL for one, prop, _ in known)


def choice(
    first: list[str], every: list[str], word: str, used: set[str], known: set[tuple[str, str, str]]
) -> list[str]:
    """Return those of the first that are used, or any of a kind that is, and of these those with exactly the name."""
    kinds = {kind for one, prop, kind in known if prop == KIND and one in used}
    alike = [one for one in every if any((one, KIND, kind) in known for kind in kinds)]
    named = [one for one in alike if (one, LABEL, word) in known]
    fitting = [one for one in first if one in used] or named or [one for one in every if one in used] or alike or every
    return [one for one in fitting if (one, LABEL, word) in known] or fitting
