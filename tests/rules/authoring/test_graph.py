from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

import pytest
from pyoxigraph import NamedNode, Triple
from rules.authoring.worlds import EX, files, write_rules

from kg.errors import RuleError
from kg.rules.authoring.graph import graph_objects, graph_picture, mermaid, rule_graph
from kg.rules.authoring.library import Library
from kg.rules.authoring.manual import manual

if TYPE_CHECKING:
    from kg.rules.authoring.graph import RuleGraph

GOLDEN: Final = Path(__file__).parent / "rules.svg"
RULES: Final = {
    "knows": "CONSTRUCT { ?x :knows ?y } WHERE { ?x :met ?y }",
    "back": "CONSTRUCT { ?y :knows ?x } WHERE { ?x :knows ?y }",
    "lonely": "CONSTRUCT { ?x a :Lonely } WHERE { ?x a :Person . FILTER NOT EXISTS { ?x :knows ?y } }",
    "sad": "CONSTRUCT { ?x a :Sad } WHERE { ?x a ?kind ; :pet ?pet }",
    "count": "CONSTRUCT { ?x :friends ?n } WHERE { { SELECT ?x (COUNT(?y) AS ?n) { ?x :knows ?y } GROUP BY ?x } }",
}


def graph(folder: Path) -> RuleGraph:
    """Return the graph of the rules."""
    return rule_graph(files(write_rules(folder, **RULES)))


def test_the_picture_is_the_one_that_was_looked_at(tmp_path: Path) -> None:
    """The drawing equals the file next to this test, which was checked by eye."""
    assert graph_picture(graph(tmp_path), "Rules") == GOLDEN.read_text(encoding="utf-8")


def test_rules_feed_those_that_read_what_they_derive(tmp_path: Path) -> None:
    """Edges have the passed terms; a rule may feed itself."""
    found = graph(tmp_path)
    assert found.terms == (":knows", "any class")
    assert {node.name for node in found.rules if node.recursive} == {"f/back", "f/sad"}
    assert found.feeds("f/knows") == ["f/back", "f/count", "f/lonely"]
    assert found.fed_by("f/sad") == ["f/lonely"]


def test_absence_and_counting_are_told_apart(tmp_path: Path) -> None:
    """Rules that test absence, or count, are marked in each form."""
    found = graph(tmp_path)
    told = {one["rule"]: [read["negated"] for read in one["reads"]] for one in graph_objects(found)}
    assert told == {"f/back": [False], "f/count": [True], "f/knows": [], "f/lonely": [True], "f/sad": [False]}
    assert mermaid(found).count("-. absent .->") == 2


def test_rules_over_a_schema_are_those_it_makes_of_them(tmp_path: Path) -> None:
    """A rule that reads any property is placed by the axioms, instead of in one cycle with all others."""
    text = "CONSTRUCT { ?y ?p ?x } WHERE { ?p a <http://www.w3.org/2002/07/owl#SymmetricProperty> . ?x ?p ?y }"
    rules = files(write_rules(tmp_path, knows=RULES["knows"], lonely=RULES["lonely"], both=text))
    with pytest.raises(RuleError, match="KG202"):
        rule_graph(
            files(write_rules(tmp_path / "x", both=text, not_met=RULES["lonely"].replace("a :Lonely", ":knows ?x")))
        )
    kind = NamedNode("http://www.w3.org/2002/07/owl#SymmetricProperty")
    a = NamedNode("http://www.w3.org/1999/02/22-rdf-syntax-ns#type")
    found = rule_graph(rules, [Triple(NamedNode(f"{EX}knows"), a, kind)])
    assert found.feeds("f/both") == ["f/lonely"]


def test_a_manual_tells_the_place_of_a_rule(tmp_path: Path) -> None:
    """The terms it reads, negates, and derives; its neighbours and strata."""
    library = Library([write_rules(tmp_path, **RULES)])
    known = manual(library, library.entries["f/lonely"])
    assert (known.reads, known.absent, known.derives) == (("a :Person",), (":knows",), ("a :Lonely",))
    assert (known.fed_by, known.feeds, known.examples) == (("f/back", "f/knows"), ("f/sad",), ())
    assert 1 <= known.strata[0] <= known.of_strata == 2
    assert [heading for heading, _ in known.sections] == ["What it infers", "Why"]
    assert known.lines[0] == (11, "PREFIX : <https://example.org/>")


def test_a_manual_survives_rules_that_cannot_be_ordered(tmp_path: Path) -> None:
    """The rule is shown, with the problem of the others."""
    loop = "CONSTRUCT { ?x :p ?y } WHERE { ?x :q ?y . FILTER NOT EXISTS { ?x :p ?y } }"
    library = Library([write_rules(tmp_path, loop=loop, knows=RULES["knows"])])
    known = manual(library, library.entries["f/knows"])
    assert (known.strata, known.problem is not None and known.problem.code) == ((), "KG202")


def test_a_rule_is_drawn_with_its_neighbours(tmp_path: Path) -> None:
    """The drawing has the rules that feed it and those it feeds, with the terms passed, and no others."""
    found = graph(tmp_path).around({"f/lonely"})
    assert [node.name for node in found.rules] == ["f/back", "f/knows", "f/lonely", "f/sad"]
    assert set(found.reads) == {(":knows", "f/lonely"), ("any class", "f/sad")}
    assert found.terms == (":knows", "any class")


def test_what_a_rule_becomes_over_a_schema_is_one_box(tmp_path: Path) -> None:
    """However many rules the axioms make of it, it is drawn once, with all their strata."""
    text = "CONSTRUCT { ?y ?p ?x } WHERE { ?p a <http://www.w3.org/2002/07/owl#SymmetricProperty> . ?x ?p ?y }"
    kind = NamedNode("http://www.w3.org/2002/07/owl#SymmetricProperty")
    a = NamedNode("http://www.w3.org/1999/02/22-rdf-syntax-ns#type")
    rules = files(write_rules(tmp_path, knows=RULES["knows"], count=RULES["count"], both=text))
    found = rule_graph(rules, [Triple(NamedNode(f"{EX}{name}"), a, kind) for name in ("knows", "friends")])
    assert [(node.name, node.strata) for node in found.rules] == [
        ("f/both", (1, 2)),
        ("f/count", (2,)),
        ("f/knows", (1,)),
    ]
