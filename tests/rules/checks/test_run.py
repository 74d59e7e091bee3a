"""Running all checks: files with syntax errors, duplicate names, rules without an order; JSON and SARIF."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from pyoxigraph import RdfFormat, parse

from kg.render.sarif import document
from kg.rules.checks.finding import Context, as_object, remark
from kg.rules.checks.run import check, read_all
from kg.rules.files import RuleSet

if TYPE_CHECKING:
    from pathlib import Path

    from kg.rules.checks.finding import Finding

PREFIX = "PREFIX : <https://example.org/>\n"


def findings(folder: Path, **files: str) -> list[Finding]:
    """Write rules into a folder and return the errors in them."""
    for name, text in files.items():
        stem, _, ending = name.rpartition("_")
        (folder / f"{stem}.{ending}").write_text(PREFIX + text)
    found = check(read_all([folder]), Context(RuleSet(())))
    return [each for each in found if each.severity == "error"]


def test_a_file_that_does_not_parse_leaves_the_others(tmp_path: Path) -> None:
    """A file with a syntax error is one finding; the others are checked."""
    (found,) = findings(
        tmp_path, bad_rq="CONSTRUCT { ?x :p ?y } WHERE { ?x :q }", good_rq="CONSTRUCT { ?x :p ?y } WHERE { ?x :q ?y }"
    )
    assert (found.code, found.rule, found.place.line) == ("KG201", "bad", 2)


def test_a_function_that_does_not_exist_is_found_at_its_place(tmp_path: Path) -> None:
    """A function that the engine lacks is an error of its file, and the others are checked."""
    bad = "CONSTRUCT { ?x :p ?z } WHERE {\n  ?x :q ?y\n  BIND(:f(?y) AS ?z) }"
    (found,) = findings(tmp_path, bad_rq=bad, good_rq="CONSTRUCT { ?x :p ?y } WHERE { ?x :q ?y }")
    assert (found.code, found.rule, found.place.line, found.place.column) == ("KG209", "bad", 4, 8)


def test_every_unknown_prefix_is_named(tmp_path: Path) -> None:
    """All undeclared prefixes are one finding, at the first."""
    text = "CONSTRUCT { ?x foo:p ?y } WHERE { ?x bar:q ?y , 'baz:s' ; foo:r [] ; :t ?y }"
    (found,) = findings(tmp_path, bad_rq=text)
    assert (found.message, found.place.column) == ("unknown prefixes `foo:`, `bar:`", 16)


def test_examples_without_a_rule(tmp_path: Path) -> None:
    """A page of examples without a rule next to it is a note; other pages are ignored."""
    examples = "# A\n\n## One\n\n```turtle given\n:a :p :b .\n```\n\n```turtle expect exactly\n```\n"
    for name, text in {"a/lost.md": examples, "a/kept.md": examples, "README.md": "# Rules\n"}.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    (tmp_path / "a" / "kept.srl").write_text(PREFIX + "RULE { ?x :p ?y } WHERE { ?x :q ?y }")
    found = [each for each in check(read_all([tmp_path]), Context(RuleSet(()))) if each.code == "KG221"]
    assert [(each.rule, each.severity) for each in found] == [("a/lost", "note")]


def test_a_rule_that_copies_everything_is_no_reader(tmp_path: Path) -> None:
    """A term read only by a rule for every triple is unread; specialised to a schema that rule reads named terms."""
    rules = {
        "copies": "CONSTRUCT { ?y ?p ?x } WHERE { ?p a owl:SymmetricProperty . ?x ?p ?y }",
        "made": "CONSTRUCT { ?x :p ?y } WHERE { ?x :q ?y }",
    }
    for name, text in rules.items():
        (tmp_path / f"{name}.rq").write_text(PREFIX + text)

    def unread(*schema: str) -> list[str]:
        axioms = tuple(quad.triple for quad in parse("".join(schema), RdfFormat.TURTLE))
        found = check(read_all([tmp_path]), Context(RuleSet(()), schema=axioms), ["made"])
        return [each.rule for each in found if each.code == "KG215"]

    symmetric = "<https://example.org/p> a <http://www.w3.org/2002/07/owl#SymmetricProperty> ."
    assert (unread(), unread(symmetric)) == (["made"], [])


def test_two_files_of_one_name(tmp_path: Path) -> None:
    """A rule in two notations is a duplicate name."""
    rule = "CONSTRUCT { ?x :p ?y } WHERE { ?x :q ?y }"
    (found,) = findings(tmp_path, same_rq=rule, same_srl="RULE { ?x :p ?y } WHERE { ?x :q ?y }")
    assert found.code == "KG207"


def test_copies_of_a_file(tmp_path: Path) -> None:
    """The same file in two folders is one rule, and no finding."""
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "same.rq").write_text(PREFIX + "CONSTRUCT { ?x :p ?y } WHERE { ?x :q ?y }")
    found = read_all([tmp_path / "a", tmp_path / "b"])
    assert ([file.name for file in found.rules.files], found.findings) == (["same"], ())


def test_rules_without_an_order(tmp_path: Path) -> None:
    """Rules that negate each other are one finding, at one of them, with both names."""
    cycle = {
        "one_rq": "CONSTRUCT { ?x a :One } WHERE { ?x :p ?y FILTER NOT EXISTS { ?x a :Two } }",
        "two_rq": "CONSTRUCT { ?x a :Two } WHERE { ?x :p ?y FILTER NOT EXISTS { ?x a :One } }",
    }
    (found,) = findings(tmp_path, **cycle)
    assert found.code == "KG202"
    assert found.rule in {"one", "two"}
    assert "one negates" in found.message
    assert "two negates" in found.message


def test_each_cycle_is_found_and_belongs_to_all_its_rules(tmp_path: Path) -> None:
    """Rules without an order are reported for each cycle, under the name of any rule in it."""
    texts = {
        "one": "CONSTRUCT { ?x a :One } WHERE { ?x :p ?y FILTER NOT EXISTS { ?x a :Two } }",
        "two": "CONSTRUCT { ?x a :Two } WHERE { ?x a :One }",
        "mints": "CONSTRUCT { [] :q ?x } WHERE { ?x :q ?y }",
        "other": "CONSTRUCT { ?x a :Other } WHERE { ?x a :Two }",
    }
    for name, text in texts.items():
        (tmp_path / f"{name}.rq").write_text(PREFIX + text)
    read = read_all([tmp_path])

    def codes(names: list[str] | None) -> list[str]:
        found = check(read, Context(RuleSet(())), names)
        return [each.code for each in found if each.severity == "error"]

    assert codes(None) == ["KG204", "KG202"]
    assert [codes([name]) for name in ("one", "two", "mints", "other")] == [["KG202"], ["KG202"], ["KG204"], []]


def test_which_rules_are_meant(tmp_path: Path) -> None:
    """Rules are selected by name, family, file or folder, even with errors; foreign ones are those outside a folder."""
    rule = PREFIX + "CONSTRUCT { ?x :p ?y } WHERE { ?x :q ?y }"
    for name, text in {"a/two.rq": rule, "a/two.srl": rule, "b/broken.srl": "RULE {"}.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    (tmp_path / "c.rq").write_text(rule)
    read = read_all([tmp_path / "a", tmp_path / "b"])
    assert read.named(str(tmp_path / "a" / "two.rq")) == read.named(str(tmp_path / "a" / "two.srl")) == ["two"]
    assert read.named(str(tmp_path / "b")) == read.named("broken") == ["broken"]
    assert read_all([tmp_path]).named("a") == ["a/two", "a/two"]
    assert read.named("none") == []
    assert read.outside([str(tmp_path / "c.rq"), str(tmp_path / "a" / "two.rq"), "a/b"]) == [tmp_path / "c.rq"]
    assert read.others_than(tmp_path / "a") == ["broken"]


def test_unbound_heads(tmp_path: Path) -> None:
    """An unbound variable of the head is named at its place."""
    (found,) = findings(tmp_path, unsafe_rq="CONSTRUCT { ?x :p ?z } WHERE { ?x :q ?y }")
    assert found.code == "KG203"
    assert "?z" in found.message


def test_json_and_sarif(tmp_path: Path) -> None:
    """Findings are machine-readable: JSON objects, and SARIF with files relative to the root."""
    found = findings(tmp_path, bad_rq="CONSTRUCT { ?x :p ?y } WHERE { ?x :q }")
    assert json.loads(json.dumps(as_object(found[0])))["code"] == "KG201"
    log = json.loads(json.dumps(document([remark(one, tmp_path) for one in found])))
    (run,) = log["runs"]
    (result,) = run["results"]
    assert result["ruleId"] == run["tool"]["driver"]["rules"][result["ruleIndex"]]["id"] == "KG201"
    location = result["locations"][0]["physicalLocation"]
    assert location["artifactLocation"]["uri"] == "bad.rq"
    assert location["region"]["startLine"] == 2
