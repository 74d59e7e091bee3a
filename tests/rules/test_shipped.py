"""The shipped rules: documented, with passing examples, and stratified."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from pyoxigraph import RdfFormat, parse

from kg.graph.ontology_files import ontology_triples
from kg.resources import folder
from kg.rules.authoring.library import Library
from kg.rules.authoring.testing import run_examples
from kg.rules.files import REQUIRED_HEADINGS
from kg.rules.reading import OPTIONAL
from kg.rules.specialise import specialise
from kg.rules.stratify import stratify

if TYPE_CHECKING:
    from kg.rules.authoring.library import Entry

RULES = folder("rules")
FAMILIES = sorted(path.name for path in RULES.iterdir() if path.is_dir())
LIBRARY = Library([RULES], families=FAMILIES)
IN_FORCE = [entry for entry in Library([RULES]).entries.values() if entry.in_force]


@pytest.mark.parametrize("family", FAMILIES)
def test_examples_pass(family: str) -> None:
    """Each rule infers the triples of its examples."""
    entries: list[Entry] = [entry for entry in LIBRARY.entries.values() if entry.name.startswith(f"{family}/")]
    assert entries
    failed = [result for result in run_examples(entries, LIBRARY) if not result.passed]
    assert not failed


@pytest.mark.parametrize("name", LIBRARY.entries)
def test_documented(name: str) -> None:
    """Each rule has a title, a description, a reason, a version, and examples next to it."""
    file = LIBRARY.read(name)
    assert file.documentation.title
    assert file.documentation.since
    assert set(REQUIRED_HEADINGS) <= set(file.documentation.sections or ())
    assert file.examples.is_file()


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
