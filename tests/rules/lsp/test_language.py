"""Language features for the text of a rule: terms, variables, words, documentation, places."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.errors import Place
from kg.rules.checks.finding import Context
from kg.rules.files import RuleSet
from kg.rules.lsp.symbols import Terms, complete, diagnose, hover, term_at, width

TURTLE = """\
@prefix : <https://example.org/> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .

:Robot a owl:Class ;
    rdfs:label "robot" ; rdfs:comment "A machine that acts." .

:drives a owl:ObjectProperty ;
    rdfs:label "drives" .
"""
RULE = """\
# Robots that drive
#
# ## What it infers
#
# That they move.

PREFIX : <https://example.org/>
CONSTRUCT { ?robot :moves true }
WHERE { ?robot a :Robot ; :drives ?wheel }
"""
PATH = Path("mine/drives.rq")


@pytest.fixture(name="terms")
def make_terms(tmp_path: Path) -> Terms:
    """Return the terms of a small ontology, one of them used by a store."""
    file = tmp_path / "small.ttl"
    file.write_text(TURTLE)
    return Terms.of([file], {"https://example.org/drives": 1200})


def texts(text: str, terms: Terms, suffix: str = ".rq") -> list[str]:
    """Return the completions at the end of a text."""
    return [each.text for each in complete(text, len(text), suffix, terms)]


def test_terms_of_a_prefix(terms: Terms) -> None:
    """A prefix is completed with the terms of its namespace, with their documentation."""
    text = RULE + "PREFIX e: <https://example.org/> e:dr"
    found = complete(text, len(text), ".rq", terms)
    assert [each.text for each in found] == ["e:Robot", "e:drives"]
    assert text[found[0].start :] == "e:dr"
    assert "A machine that acts." in found[0].documentation


def test_variables_of_the_text(terms: Terms) -> None:
    """A question mark is completed with the variables of the text."""
    assert texts(RULE + "?", terms) == ["?robot", "?wheel"]


def test_words_of_the_notation(terms: Terms) -> None:
    """Other positions are completed with keywords of the notation, prefixes and functions."""
    assert "OPTIONAL" in texts("", terms)
    assert "SET" in texts("", terms, ".srl")
    assert {"rnkg:", "REGEX("} <= set(texts("", terms))
    assert "REGEX(" not in texts("", terms, ".ttl")


def test_hover_over_a_term_and_over_the_header(terms: Terms) -> None:
    """A term shows its documentation and number of uses; the header shows the documentation."""
    assert "1,200 triples" in (hover(RULE, RULE.index(":drives") + 2, PATH, "mine/drives", terms) or "")
    assert "That they move." in (hover(RULE, 3, PATH, "mine/drives", terms) or "")
    assert hover(RULE, RULE.index("?wheel"), PATH, "mine/drives", terms) is None


def test_definitions(terms: Terms) -> None:
    """A term leads to the line of the ontology that defines it."""
    term = term_at(RULE, RULE.index(":Robot") + 1, terms)
    assert term is not None
    assert term.place is not None
    assert (Path(term.place.path).name, term.place.line) == ("small.ttl", 5)
    assert term_at(RULE, RULE.index("WHERE"), terms) is None


def test_how_wide_a_diagnostic_is() -> None:
    """A finding marks the token at its place, a line of the header, or a single character."""
    places = {(1, 1): 19, (3, 3): 17, (8, 20): 6, (8, 13): 6, (9, 27): 7, (9, 8): 1, (8, 2): 1, (90, 1): 1, (6, 1): 1}
    for (line, column), expected in places.items():
        assert width(RULE.replace("\n", "\r\n"), Place("a.rq", line, column)) == expected, (line, column)
    assert width('"""long\nstring"""', Place("a.ttl", 1, 1)) == len('"""long')


def test_diagnostics(terms: Terms) -> None:
    """Syntax errors and findings of checks have their places."""
    assert terms.by_iri
    context = Context(RuleSet(()), frozenset({"https://example.org/drives"}))
    (broken,) = diagnose(RULE.replace("WHERE {", "WHERE"), PATH, "mine/drives", context)
    assert (broken.code, broken.place.line) == ("KG201", 9)
    assert {each.code for each in diagnose(RULE, PATH, "mine/drives", context)} >= {"KG211", "KG217"}


@given(st.text(alphabet="?:ab {}.#<>\"'\n", max_size=60), st.integers(0, 60))
def test_any_text_is_answered(text: str, offset: int) -> None:
    """Any text in an editor gets a response without an error."""
    offset = min(offset, len(text))
    complete(text, offset, ".rq", Terms())
    hover(text, offset, PATH, "mine/drives", Terms())
    diagnose(text, PATH, "mine/drives", Context(RuleSet(())))
