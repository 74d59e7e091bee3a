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


def test_alternatives_are_a_union_and_paths_are_paths_in_sparql() -> None:
    """A file of SPARQL has one rule, without auxiliary predicates."""
    printed = to_rq(rules_of("CONSTRUCT { ?x <urn:h> ?y } WHERE { ?x <urn:p>+|<urn:q> ?y }"))
    assert printed.count("CONSTRUCT") == printed.count("UNION") == 1
    assert "?x (<urn:p>)+ ?y ." in printed
    assert "auxiliary" not in printed


def test_rules_with_other_heads_have_variables_of_their_own_in_sparql() -> None:
    """A solution of one rule leaves the triples of the others out."""
    text = "RULE { ?x <urn:h> 1 } WHERE { ?x <urn:p> ?y } RULE { ?x <urn:k> 2 } WHERE { ?x <urn:q> ?y }"
    printed = to_rq(rules_of(text, ".srl"))
    assert printed.count("?x·1") == printed.count("?x·2") == 2


def test_facts_beside_a_rule_have_no_sparql() -> None:
    """A triple without variables would follow from each of the bodies; the error has a place and a way out."""
    text = "RULE { <urn:a> <urn:h> 1 } WHERE { ?x <urn:p> ?y } RULE { ?x <urn:k> 2 } WHERE { ?x <urn:q> ?y }"
    with pytest.raises(RuleError, match="cannot tell apart") as caught:
        to_rq(rules_of(text, ".srl"))
    assert caught.value.code == "KG209"
    assert caught.value.place
    assert caught.value.hint


def test_variables_that_shacl_binds_have_other_names_in_a_shape() -> None:
    """`$this` is the focus node, which a rule of another notation does not mean."""
    printed = to_turtle(rules_of("CONSTRUCT { ?this <urn:h> ?y } WHERE { ?y <urn:p> ?this FILTER(?y != ?this) }"))
    assert "?this " not in printed
    assert "?this·1 <urn:h> ?y" in printed


def test_data_of_a_file_is_printed_with_its_rules(tmp_path: Path) -> None:
    """DATA stays DATA in SPARQL RL; elsewhere it is a rule without a condition."""
    (tmp_path / "stated.srl").write_text("DATA { <urn:a> <urn:p> 1 }\nRULE { ?x <urn:q> 2 } WHERE { ?x <urn:p> 1 }\n")

    def printed(notation: str) -> str:
        found = CliRunner().invoke(app, ["rules", "compile", "stated", "--to", notation, "--rules", str(tmp_path)])
        return found.stdout or found.stderr

    assert "\nDATA {\n  <urn:a> <urn:p> " in printed("srl")
    assert "<urn:a> <urn:p> " in printed("ttl")
    assert "cannot tell apart" in printed("rq")


def test_a_file_that_derives_nothing_is_not_printed(tmp_path: Path) -> None:
    """KG209 instead of an empty text, which is not a file of rules."""
    (tmp_path / "nothing.rq").write_text("CONSTRUCT { ?x <urn:p> ?x } WHERE { ?x <urn:q> ?y FILTER(false) }")
    found = CliRunner().invoke(app, ["rules", "compile", "nothing", "--to", "rq", "--rules", str(tmp_path)])
    assert (found.exit_code, "KG209" in found.stderr) == (1, True)
