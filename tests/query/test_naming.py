"""Facts typed by users: terms in full, prefixed names, literals, and names of things in the store."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from pyoxigraph import Literal, NamedNode, Store

from kg.errors import UnknownNameError, UsageError
from kg.query.naming import facts, terms

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pyoxigraph import QueryBoolean, QuerySolutions, QueryTriples

DATA = """
PREFIX : <https://w3id.org/rnkg/>
PREFIX rnkg: <https://w3id.org/rnkg/ns#>
PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#>
INSERT DATA {
  :talker rdfs:label "talker" ; a :Node ; rnkg:publishes :chatter ; rnkg:line 5 .
  :exe rdfs:label "talker" ; a :Executable .
  :listener rdfs:label "listener" ; a :Node .
  :chatter rdfs:label "/chatter" .
  :odom rdfs:label "/odom" .
}"""


class Snapshot:
    """A store with the interface of a snapshot."""

    def __init__(self) -> None:
        self.store = Store()
        self.store.update(DATA)

    def query(
        self, text: str, *, prefixes: Mapping[str, str] | None = None
    ) -> QuerySolutions | QueryBoolean | QueryTriples:
        """Run a query."""
        return self.store.query(text, prefixes=dict(prefixes or {}))


STORE = Snapshot()
BASE = "https://w3id.org/rnkg/"


@pytest.mark.parametrize(
    ("word", "term"),
    [
        ("<https://e.org/x>", NamedNode("https://e.org/x")),
        ("https://e.org/x", NamedNode("https://e.org/x")),
        ("rnkg:Node", NamedNode(BASE + "ns#Node")),
        ("5", Literal("5", datatype=NamedNode("http://www.w3.org/2001/XMLSchema#integer"))),
        ("true", Literal(True)),
        ('"a b"@en', Literal("a b", language="en")),
        ("chatter", NamedNode(BASE + "chatter")),
        ("/chatter", NamedNode(BASE + "chatter")),
    ],
)
def test_words(word: str, term: object) -> None:
    """A word resolves to the term that it spells, or to the thing with that name."""
    assert terms(STORE, word) == [term]


def test_a_fact_that_is_held_says_which_thing_is_meant() -> None:
    """Of two things with the same name, the one whose fact is in the store is chosen."""
    found, held = facts(STORE, "talker", "publishes", "chatter")
    assert held
    assert [fact.subject for fact in found] == [NamedNode(BASE + "talker")]


def test_a_fact_that_is_not_held_goes_by_what_the_property_is_used_with() -> None:
    """Of two things with the same name, the one that has the property, or is of a class that has it, is chosen."""
    found, held = facts(STORE, "talker", "publishes", "odom")
    assert not held
    assert [fact.subject for fact in found] == [NamedNode(BASE + "talker")]


def test_the_name_of_an_end_means_what_it_connects_to() -> None:
    """Of the ends with this name, the topic of that of the subject is chosen."""
    store = Snapshot()
    store.store.update(f"""PREFIX : <{BASE}> PREFIX rnkg: <{BASE}ns#> INSERT DATA {{
      <{BASE}talker#out> rnkg:name "~/out" ; rnkg:connectsTo :own .
      <{BASE}other#out> rnkg:name "~/out" ; rnkg:connectsTo :theirs .
      :talker rnkg:publishes :own .
    }}""")
    (fact,), held = facts(store, "talker", "publishes", "~/out")
    assert (fact.object, held) == (NamedNode(BASE + "own"), True)


def test_unknown_words_get_suggestions() -> None:
    """A name or property that nothing has is refused with suggestions."""
    with pytest.raises(UnknownNameError) as name:
        terms(STORE, "talkr")
    assert name.value.hint == "Did you mean `talker`?"
    with pytest.raises(UnknownNameError) as missing:
        terms(STORE, "publish", property_=True)
    assert "rnkg:publishes" in (missing.value.hint or "")
    with pytest.raises(UnknownNameError) as unlike:
        terms(STORE, "xyzzy", property_=True)
    assert "lists the properties" in (unlike.value.hint or "")
    with pytest.raises(UsageError):
        terms(STORE, '"open')


def test_ambiguous_words_are_asked_about() -> None:
    """If a name remains ambiguous, the IRIs are listed."""
    with pytest.raises(UsageError) as error:
        facts(STORE, "listener", "publishes", "talker")
    assert BASE + "exe" in (error.value.hint or "")


def test_labels_in_a_language_and_ends_of_iris() -> None:
    """A thing is found by its English label, and by the end of its IRI."""
    store = Snapshot()
    store.store.update(
        f'INSERT DATA {{ <{BASE}x#ranging> <http://www.w3.org/2000/01/rdf-schema#label> "measure it"@en }}'
    )
    assert terms(store, "measure it") == terms(store, "ranging") == [NamedNode(BASE + "x#ranging")]


def test_prefixes_of_rules_and_unknown_ones() -> None:
    """Given prefixes apply; an unknown one is an error."""
    assert terms(STORE, "my:x", prefixes={"my": "https://m.org/"}) == [NamedNode("https://m.org/x")]
    with pytest.raises(UnknownNameError, match="`my:` is not a known prefix"):
        terms(STORE, "my:x", property_=True)


def test_a_property_that_nothing_has_is_named_before_things_are_asked_about() -> None:
    """A misspelt property is reported before an ambiguous name."""
    with pytest.raises(UnknownNameError) as error:
        facts(STORE, "talker", "rnkg:publishs", "odom")
    assert "`rnkg:publishes`" in (error.value.hint or "")


def test_exact_names_leave_out_what_only_ends_in_them() -> None:
    """A word resolves to exact names; ends of IRIs are included unless exact names are required."""
    assert terms(STORE, "exe", among=None) == []
    assert terms(STORE, "exe") == [NamedNode(BASE + "exe")]
    assert terms(STORE, "chatter", among=None) == terms(STORE, "chatter")


def test_held_facts_need_no_names_that_only_end_in_words() -> None:
    """A fact with exact names is found without reading all names, which takes seconds."""
    asked: list[str] = []

    class Told(Snapshot):
        def query(
            self, text: str, *, prefixes: Mapping[str, str] | None = None
        ) -> QuerySolutions | QueryBoolean | QueryTriples:
            asked.append(text)
            return super().query(text, prefixes=prefixes)

    assert facts(Told(), "talker", "publishes", "chatter")[1]
    assert not any("STRENDS" in text or "?s ?name ?o" in text for text in asked)


def test_a_node_in_code_communicates_over_a_topic_in_code() -> None:
    """A topic that launch files have too is the one without a launch file, if the node is in none."""
    store = Snapshot()
    store.store.update(f"""PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#> INSERT DATA {{
      <{BASE}configuration/local/ws/-/a.launch#topic/odom> rdfs:label "/odom" .
      <{BASE}configuration/local/ws/-/b.launch#topic/odom> rdfs:label "/odom" .
    }}""")
    (fact,), held = facts(store, "listener", "rnkg:publishes", "odom")
    assert (fact.object, held) == (NamedNode(BASE + "odom"), False)
