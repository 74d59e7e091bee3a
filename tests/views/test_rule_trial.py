"""A trial of a rule gives the inferences of one step of the rule engine."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Final

import pytest

from kg.graph.vocabulary import RNKG
from kg.pipeline.reasoning import explained_vocabulary
from kg.rules.authoring.firing import fire
from kg.rules.authoring.runs import triples_of
from kg.rules.columns import read_columns, union_of, wanted
from kg.rules.engine.terms import Dictionary
from kg.rules.explain.view import View
from kg.rules.reading import read_text
from kg.rules.recording import Names
from kg.views import rule_trial
from kg.views.rule_trial import trial

if TYPE_CHECKING:
    from pyoxigraph import Triple

    from kg.rules.files import RuleFile
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

RULES: Final = {
    "negation": """CONSTRUCT { ?n my:is my:deaf }
        WHERE { ?n rnkg:publishes ?t FILTER NOT EXISTS { ?n rnkg:subscribes ?t } }""",
    "filter": """CONSTRUCT { ?n my:likes ?t } WHERE { ?n rnkg:publishes ?t .
        FILTER NOT EXISTS { ?n rnkg:publishes ?u FILTER(STR(?u) < STR(?t)) } }""",
    "later": """CONSTRUCT { ?n my:likes ?u } WHERE { ?n rnkg:publishes ?t .
        FILTER EXISTS { ?m rnkg:subscribes ?t }
        ?m rnkg:publishes ?u . ?u rnkg:hasMessage ?k . ?t rnkg:hasMessage ?k }""",
    "nested": """CONSTRUCT { ?n my:is my:heard } WHERE { ?n rnkg:publishes ?t .
        FILTER NOT EXISTS { ?n rnkg:publishes ?u FILTER NOT EXISTS { ?u rnkg:hasMessage ?k } } }""",
    "maybe": """CONSTRUCT { ?n my:with ?m } WHERE { ?n rnkg:publishes ?t OPTIONAL { ?m rnkg:subscribes ?t } }""",
    "either": "CONSTRUCT { ?n my:has ?t } WHERE { { ?n rnkg:publishes ?t } UNION { ?n rnkg:subscribes ?t } }",
    "made": "CONSTRUCT { ?n my:has [ my:of ?t ] } WHERE { ?n rnkg:publishes ?t OPTIONAL { ?t rdfs:comment ?c } }",
    "counted": """CONSTRUCT { ?n my:many ?k }
        WHERE { { SELECT ?n (COUNT(?t) AS ?k) WHERE { ?n rnkg:publishes ?t } GROUP BY ?n } }""",
    "literals": "CONSTRUCT { ?l my:of ?t } WHERE { ?t rnkg:name|rnkg:publishes ?l }",
    "known": "CONSTRUCT { ?n a ros:Node } WHERE { ?n rnkg:publishes ?t }",
}


def _file(text: str, name: str) -> RuleFile:
    return read_text(f"PREFIX my: <https://example.org/mine#>\n{text}", Path("rules", f"{name}.rq"), f"mine/{name}")


def _by_the_engine(snapshot: EmbeddedSnapshot, settings: Settings, file: RuleFile) -> tuple[set[Triple], set[Triple]]:
    """Return the inferences of the rule engine, and the known ones among them."""
    names, dictionary = Names.of(settings.base, RNKG), Dictionary()
    graphs = [None, *(graph for graph in snapshot.graphs() if graph != names.builds)]
    known = read_columns(snapshot, wanted(file.rules), graphs, dictionary)
    heads = union_of([facts for firing in fire(file.rules, dictionary, known, known) for facts in firing.heads])
    found = set(triples_of(heads, dictionary))
    return found, found & set(triples_of(known, dictionary))


@pytest.mark.parametrize("name", RULES)
def test_a_trial_tells_what_the_engine_of_rules_infers(
    snapshot: EmbeddedSnapshot, settings: Settings, name: str
) -> None:
    """Facts are the same, including blank nodes and known ones, for any body."""
    file = _file(RULES[name], name)
    expected, known = _by_the_engine(snapshot, settings, file)
    found = trial(View(snapshot, explained_vocabulary(settings), file.rules), file, 10_000)
    assert found.whole
    assert {one.fact for one in found.facts} == expected
    assert {one.fact for one in found.facts if one.known} == known
    assert (found.looked, found.fresh) == (len(expected), len(expected - known))
    assert expected


def test_paths_are_followed(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A path of any length is a chain of premises."""
    file = _file("CONSTRUCT { ?c my:under ?d } WHERE { ?c rnkg:feeds+ ?d }", "under")
    found = trial(View(snapshot, explained_vocabulary(settings), file.rules), file, 10_000)
    far = [one for one in found.facts if len(one.derivation.facts) > 1]
    assert found.whole
    assert far
    for one in far:
        first, *_, last = one.derivation.facts
        assert (first.subject, last.object) == (one.fact.subject, one.fact.object)


def test_a_trial_that_takes_long_tells_what_it_has_found(
    snapshot: EmbeddedSnapshot, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each rule of a file gets its share of the time; the numbers are then lower bounds."""
    file = _file(RULES["either"], "either")
    view = View(snapshot, explained_vocabulary(settings), file.rules)
    every = trial(view, file, 10).looked
    ticks = iter(range(10_000_000))
    # A clock of its own: servers of other tests in this process have threads that read the time, too.
    monkeypatch.setattr(rule_trial, "time", SimpleNamespace(monotonic=lambda: float(next(ticks))))
    monkeypatch.setattr(rule_trial, "_SECONDS", 40.0)
    found = trial(view, file, 100)
    assert not found.whole
    assert 20 < found.looked < every
    assert {str(one.derivation.rule) for one in found.facts} == {"mine/either", "mine/either#2"}
