from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from rules.authoring.worlds import bench, files, write_rules

from kg.errors import RuleError
from kg.rules.authoring.differences import difference, difference_objects
from kg.rules.authoring.spelling import spell_triple
from kg.rules.engine.limits import Limits

if TYPE_CHECKING:
    from pathlib import Path

    from kg.rules.authoring.differences import Difference

KNOWS = "CONSTRUCT { ?x :knows ?y } WHERE { ?x :met ?y }"
BACK = "CONSTRUCT { ?y :knows ?x } WHERE { ?x :knows ?y }"
MET = "CONSTRUCT { ?x a :Met } WHERE { ?x :met ?y }"


def told(found: Difference) -> list[tuple[str, str, tuple[str, ...]]]:
    """Return the changes as text."""
    prefixes = {"": "https://example.org/"}
    return [(change.sign, spell_triple(change.triple, prefixes), change.rules) for change in found.changes]


def test_what_comes_and_what_goes(tmp_path: Path) -> None:
    """Newly inferred triples are added; stored ones that no rule derives any more are removed."""
    rules = write_rules(tmp_path / "rules", knows=KNOWS)
    found = difference(bench(tmp_path, ":a :met :b .", ":a :knows :c ; :saw :b ."), files(rules))
    assert told(found) == [
        ("+", ":a :knows :b", ("f/knows",)),
        ("-", ":a :knows :c", ("f/knows",)),
        ("-", ":a :saw :b", ()),
    ]
    assert found.by_rule == {"f/knows": (1, 1)}


def test_nothing_changes_when_the_rules_were_run(tmp_path: Path) -> None:
    """Triples already inferred or asserted in the store are not changes."""
    rules = write_rules(tmp_path / "rules", knows=KNOWS)
    found = difference(bench(tmp_path, ":a :met :b ; :knows :b . :c :met :d .", ":c :knows :d ."), files(rules))
    assert not found
    assert list(difference_objects(found)) == [{"diff": True, "added": 0, "removed": 0, "rules": {}}]


def test_of_a_chosen_rule_also_what_others_make_of_it(tmp_path: Path) -> None:
    """Triples added without the chosen rule are omitted; those that others derive from it are included."""
    rules = write_rules(
        tmp_path / "rules", knows=KNOWS, back=BACK, other="CONSTRUCT { ?x a :Met } WHERE { ?x :met ?y }"
    )
    every = files(rules)
    chosen = [file for file in every if file.name == "f/knows"]
    found = difference(bench(tmp_path, ":a :met :b ."), every, chosen)
    assert told(found) == [("+", ":a :knows :b", ("f/back", "f/knows")), ("+", ":b :knows :a", ("f/back",))]


def test_of_a_chosen_rule_only_what_it_may_have_derived_goes(tmp_path: Path) -> None:
    """Triples that neither the chosen rule nor its successors derive are omitted, although a run would remove them."""
    rules = write_rules(
        tmp_path / "rules", knows=KNOWS, back=BACK, other="CONSTRUCT { ?x a :Met } WHERE { ?x :met ?y }"
    )
    every = files(rules)
    chosen = [file for file in every if file.name == "f/knows"]
    found = difference(bench(tmp_path, ":a :saw :b .", ":a :knows :b ; a :Met ; :was :b ."), every, chosen)
    assert told(found) == [("-", ":a :knows :b", ("f/back", "f/knows"))]


def test_rules_over_a_schema_are_cut_to_that_of_the_store(tmp_path: Path) -> None:
    """A rule that reads axioms and any property is applied to the axioms of the store."""
    text = "CONSTRUCT { ?y ?p ?x } WHERE { ?p a <http://www.w3.org/2002/07/owl#SymmetricProperty> . ?x ?p ?y }"
    rules = write_rules(tmp_path / "rules", symmetric=text)
    found = difference(bench(tmp_path, ":met a owl:SymmetricProperty . :a :met :b ; :saw :c ."), files(rules))
    assert told(found) == [("+", ":b :met :a", ("f/symmetric",))]


def test_a_limit_ends_it(tmp_path: Path) -> None:
    """A limit is KG205, as for a run."""
    rules = write_rules(tmp_path / "rules", knows=KNOWS)
    with pytest.raises(RuleError, match="KG205"):
        difference(bench(tmp_path, ":a :met :b , :c ."), files(rules), limits=Limits(max_triples=1))


def test_what_no_rule_gives_is_spelt_as_the_rules_do(tmp_path: Path) -> None:
    """Prefixes common to all files apply even if no rule derives the triple any more; those of Turtle, too."""
    rules = write_rules(tmp_path / "rules", knows=KNOWS)
    (tmp_path / "rules" / "f" / "shape.ttl").write_text(
        "@prefix own: <https://example.org/own/> .\n@prefix sh: <http://www.w3.org/ns/shacl#> .\n"
        "own:S a sh:NodeShape ; sh:targetSubjectsOf own:p ;\n"
        "  sh:rule [ a sh:TripleRule ; sh:subject sh:this ; sh:predicate own:q ; sh:object own:r ] .\n"
    )
    inferred = ":a <https://example.org/own/gone> :b ."
    (gone,) = difference(bench(tmp_path, ":a :saw :b .", inferred), files(rules)).changes
    assert gone.rules == ()
    assert spell_triple(gone.triple, gone.prefixes) == ":a own:gone :b"
