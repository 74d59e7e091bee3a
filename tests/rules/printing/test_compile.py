from __future__ import annotations

from pathlib import Path
from typing import Final

import pytest
from typer.testing import CliRunner

from kg.cli.app import app
from kg.errors import RuleError
from kg.rules.form import Atom, Rule
from kg.rules.printing import to_rq, to_srl, to_turtle
from kg.rules.reading import read_text

TEXT: Final = """\
# Ancestors
#
# ## What it infers
#
# Who came before.
#
# ## Why
#
# To have an example.

PREFIX : <urn:>

CONSTRUCT { ?x :ancestor ?y } WHERE { ?x :parent/:parent ?y }
"""

FORM: Final = """\
rule mine/ancestor
  at            mine/ancestor.rq:13:1
  stratum       1
  reads         :parent
  writes        :ancestor
  head
    ?x :ancestor ?y
  body
    ?x :parent ?_·1
    ?_·1 :parent ?y
"""

SPARQL: Final = """\
PREFIX : <urn:>

CONSTRUCT {
  ?x :ancestor ?y .
}
WHERE {
  ?x :parent ?_·1 .
  ?_·1 :parent ?y .
}
"""

RULE_LANGUAGE: Final = """\
PREFIX : <urn:>

RULE {
  ?x :ancestor ?y .
} WHERE {
  ?x :parent ?_·1 .
  ?_·1 :parent ?y .
}
"""

SHACL: Final = """\
@prefix : <urn:> .
@prefix sh: <http://www.w3.org/ns/shacl#> .

<urn:kg:shape:mine/ancestor:1> a sh:NodeShape ;
  sh:targetSubjectsOf :parent ;
  sh:rule [
    a sh:TripleRule ;
    sh:subject sh:this ;
    sh:predicate :ancestor ;
    sh:object [ sh:path ( :parent :parent ) ]
  ] .
"""


def rules_of(body: str, ending: str = ".rq") -> tuple[Rule, ...]:
    """Return the rules of a text."""
    return read_text(f"# A title\n{body}\n", Path(f"rule{ending}"), "test/rule").rules


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a working folder with one rule."""
    file = tmp_path / "rules" / "mine" / "ancestor.rq"
    file.parent.mkdir(parents=True)
    file.write_text(TEXT, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path / "rules"


@pytest.mark.parametrize(("notation", "printed"), [("rq", SPARQL), ("srl", RULE_LANGUAGE), ("ttl", SHACL)])
def test_compile_prints_a_rule_in_any_notation(folder: Path, notation: str, printed: str) -> None:
    """The rule is printed on standard output, with names shortened by the prefixes of its file."""
    result = CliRunner().invoke(app, ["rules", "compile", "ancestor", "--to", notation, "--rules", str(folder)])
    assert result.exit_code == 0, result.stderr
    assert result.stdout == printed


def test_compile_prints_the_internal_form(folder: Path) -> None:
    """Without a notation it prints the triples read and written by the rule, and its elements one a line."""
    result = CliRunner().invoke(app, ["rules", "compile", "mine/ancestor", "--rules", str(folder)])
    assert result.exit_code == 0, result.stderr
    lines = result.stdout.split("\n")
    expected = FORM.split("\n")
    assert lines[1].endswith("mine/ancestor.rq:13:1")
    assert lines[2].split()[0] == "stratum"
    assert [lines[0], *lines[3:]] == [expected[0], *expected[3:]]


def test_compile_refuses_a_notation_that_is_none(folder: Path) -> None:
    """KG003 lists the valid ones."""
    result = CliRunner().invoke(app, ["rules", "compile", "ancestor", "--to", "n3", "--rules", str(folder)])
    assert result.exit_code == 2
    assert "form, rq, srl, ttl" in result.stderr


@pytest.mark.parametrize(
    ("body", "lacks"),
    [
        ("?x <urn:p> ?z { SELECT ?z (COUNT(*) AS ?y) { ?z <urn:q> ?w } GROUP BY ?z }", "aggregates"),
        ("GRAPH ?g { ?x <urn:p> ?y }", "more of SPARQL"),
        ("VALUES ?x { <urn:a> } ?x <urn:p> ?y", "VALUES"),
        ("?x <urn:p> ?y FILTER EXISTS { ?x <urn:q> ?y }", "EXISTS"),
        ("?x <urn:p> ?y FILTER(COALESCE(?y > 1, true))", "COALESCE"),
        ("?x <urn:p> ?y FILTER NOT EXISTS { BIND(1 AS ?z) ?x <urn:q> ?z }", "an assignment inside NOT"),
    ],
)
def test_rule_language_says_what_it_lacks(body: str, lacks: str) -> None:
    """KG209 names the unsupported feature, the place of the rule, and an alternative."""
    with pytest.raises(RuleError) as caught:
        to_srl(rules_of(f"CONSTRUCT {{ ?x <urn:h> ?y }} WHERE {{ {body} }}"))
    assert caught.value.code == "KG209"
    assert lacks in caught.value.message
    assert caught.value.place
    assert caught.value.hint


def test_sparql_and_shacl_have_no_asserted_data() -> None:
    """Atoms over asserted data are printed as SPARQL RL only, for all of a body or all of a NOT."""
    rules = rules_of("RULE { ?x <urn:h> ?y } WHERE DATA { ?x <urn:p> ?y NOT { ?y <urn:q> ?x } }", ".srl")
    assert "WHERE DATA {" in to_srl(rules)
    for printer in (to_rq, to_turtle):
        with pytest.raises(RuleError, match="asserted data alone"):
            printer(rules)
    (rule,) = rules_of("RULE { ?x <urn:h> ?y } WHERE { ?x <urn:p> ?y NOT DATA { ?y <urn:q> ?x } }", ".srl")
    assert "NOT DATA {" in to_srl([rule])
    mixed = Rule(rule.name, rule.head, (*rule.body, Atom(*rule.head[0].positions, asserted=True)), rule.place)
    with pytest.raises(RuleError, match="a part of its body"):
        to_srl([mixed])


def test_several_rules_as_sparql_stand_behind_their_names() -> None:
    """A choice gives several queries, separated by comments with their names."""
    printed = to_rq(rules_of("CONSTRUCT { ?x <urn:h> ?y } WHERE { ?x <urn:p>|<urn:q> ?y }"))
    assert [line for line in printed.split("\n") if line.startswith("#")] == ["# test/rule", "# test/rule#2"]
