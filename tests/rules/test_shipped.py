"""The shipped rules: documented, with passing examples, and stratified."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from pyoxigraph import RdfFormat, parse

from kg.graph.ontology_files import ontology_triples
from kg.resources import folder
from kg.rules.authoring import starting
from kg.rules.authoring.examples import read_examples
from kg.rules.authoring.library import Library
from kg.rules.authoring.starting import start
from kg.rules.authoring.testing import run_examples
from kg.rules.checks.documents import documentation_missing, examples_missing
from kg.rules.checks.finding import Context
from kg.rules.files import RuleFile, RuleSet
from kg.rules.reading import OPTIONAL
from kg.rules.specialise import specialise
from kg.rules.stratify import stratify

if TYPE_CHECKING:
    from kg.rules.authoring.library import Entry

RULES = folder("rules")
FAMILIES = sorted(path.name for path in RULES.iterdir() if path.is_dir())
LIBRARY = Library([RULES], families=FAMILIES)
IN_FORCE = [entry for entry in Library([RULES]).entries.values() if entry.in_force]
NO_CONTEXT = Context(RuleSet(()))
TEMPLATE = Path(starting.__file__).parent / "templates" / "examples.md"
EXAMPLES_OF_NEW_RULES = set(re.findall(r"^## (.*)", TEMPLATE.read_text(), re.MULTILINE))


@pytest.mark.parametrize("family", FAMILIES)
def test_examples_pass(family: str) -> None:
    """Each rule infers the triples of its examples."""
    entries: list[Entry] = [entry for entry in LIBRARY.entries.values() if entry.name.startswith(f"{family}/")]
    assert entries
    failed = [result for result in run_examples(entries, LIBRARY) if not result.passed]
    assert not failed


def lacking(file: RuleFile) -> list[str]:
    """Return what a rule needs before it is shipped: documentation, and examples of its own."""
    found = [*documentation_missing(file, NO_CONTEXT), *examples_missing(file, NO_CONTEXT)]
    own = file.examples.is_file() and not EXAMPLES_OF_NEW_RULES & {each.title for each in read_examples(file.examples)}
    return [*(each.message for each in found), *(() if own else ("the examples are those of a new rule",))]


@pytest.mark.parametrize("name", LIBRARY.entries)
def test_documented(name: str) -> None:
    """Each rule has a title, a description, a reason, a version, and examples of its own next to it."""
    assert not lacking(LIBRARY.read(name))


@pytest.mark.parametrize("notation", ["rq", "ttl", "srl"])
def test_a_new_rule_must_be_completed(tmp_path: Path, notation: str) -> None:
    """The unchanged output of `kg rules new` has neither a reason nor examples of its own."""
    start("communication/listens-to", tmp_path, notation)
    found = lacking(Library([tmp_path]).read("communication/listens-to"))
    assert found == ["the header lacks text below `## Why`", "the examples are those of a new rule"]


def test_every_example_has_its_rule() -> None:
    """Every page of examples has its rule."""
    pages = {path.relative_to(RULES).with_suffix("").as_posix() for path in RULES.rglob("*.md")}
    assert pages == set(LIBRARY.entries)


def test_the_rules_in_force_have_an_order() -> None:
    """With the shipped ontologies, the rules can be stratified, and none creates terms in recursion."""
    axioms = [quad.triple for quad in parse(ontology_triples(), RdfFormat.N_TRIPLES)]
    rules = [rule for entry in IN_FORCE for rule in LIBRARY.read(entry.name).rules]
    assert stratify(specialise(rules, axioms))


def test_all_three_notations_are_used() -> None:
    """The active rules use SPARQL, SPARQL RL and SHACL."""
    assert {entry.path.suffix for entry in IN_FORCE} == {".rq", ".srl", ".ttl"}


def test_optional_families_are_in_force_where_they_are_named() -> None:
    """A family with a file `optional` is excluded unless it is named; then it is the only one."""
    optional = {path.parent.name for path in RULES.rglob(OPTIONAL)}
    assert optional == {"owl-rl"}
    assert not [entry for entry in IN_FORCE if entry.name.split("/")[0] in optional]
    named = Library([RULES], families=optional).entries.values()
    assert {entry.name.split("/")[0] for entry in named if entry.in_force} == optional
