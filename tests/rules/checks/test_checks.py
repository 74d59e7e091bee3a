"""Each check has the expected findings of its cases at their places, and none in other cases.

A case is a rule in `cases/CODE/`; a line `# expect: CODE line:column words` at its end gives an expected finding.
"""

from __future__ import annotations

import re
import threading
from dataclasses import replace
from itertools import permutations
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from pyoxigraph import NamedNode
from rules.explain.worlds import EX, World

from kg.rules import authoring
from kg.rules.checks.documents import SCAFFOLD
from kg.rules.checks.finding import Context
from kg.rules.checks.firing import StoreOf, nothing
from kg.rules.checks.run import CHECKS, check_file
from kg.rules.checks.subsumed import subsumes
from kg.rules.explain.view import View, Vocabulary
from kg.rules.files import NOTATIONS, RuleSet
from kg.rules.reading import read, read_text

if TYPE_CHECKING:
    from kg.rules.form import Element

FOLDER = Path(__file__).parent / "cases"
CASES = sorted(path for path in FOLDER.rglob("*") if path.suffix in NOTATIONS)
DATA = ":ann a :Person ; :knows :bo . :bo :likes :ann ; :met :ann ."
TERMS = frozenset(EX + name for name in ("knows", "likes", "hates", "met", "Person"))
OTHERS = f"PREFIX : <{EX}> CONSTRUCT {{ ?x :met ?y }} WHERE {{ ?y :met ?x }}"
EXPECTATION = re.compile(r"# expect: (\w+) (\d+:\w+) (.*)")


def context(path: Path) -> Context:
    """Return the context of a case: a small store, some terms, one other rule and one stored query."""
    vocabulary = Vocabulary(NamedNode(EX + "inferred"))
    other = read_text(OTHERS, Path("aa/met-both-ways.rq"), "aa/met-both-ways")
    rules = RuleSet((read(path, f"case/{path.stem}"), other))
    store = StoreOf(View(World(DATA, ()), vocabulary))
    return Context(rules, TERMS, frozenset({EX + "likes"}), store, nothing(vocabulary))


@pytest.mark.parametrize("path", CASES, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_case(path: Path) -> None:
    """A case has exactly the findings of its check that its last lines expect."""
    code = path.parent.name
    expected = [match.groups() for match in map(EXPECTATION.fullmatch, path.read_text().splitlines()) if match]
    given = context(path)
    found = [finding for finding in check_file(given.rules.files[0], given) if finding.code == code]
    assert [(each.code, f"{each.place.line}:{each.place.column}") for each in found] == [(c, p) for c, p, _ in expected]
    for finding, (_, _, words) in zip(found, expected, strict=True):
        assert words in f"{finding.message} {finding.hint}"


def test_every_check_has_cases_for_and_against() -> None:
    """Each check has a case with a finding and one without."""
    for code in CHECKS:
        expecting = ["# expect:" in path.read_text() for path in CASES if path.parent.name == code]
        assert {True, False} <= set(expecting), code


class _Endless:
    """A store that responds on command."""

    def __init__(self) -> None:
        self.answer = threading.Event()

    def matches(self, _body: tuple[Element, ...]) -> bool:
        """Wait."""
        return self.answer.wait(60)

    def failing(self, _body: tuple[Element, ...]) -> None:
        """Return nothing."""


def test_what_is_to_be_replaced_in_a_new_rule() -> None:
    """Each template of new rules has the sentence that counts as missing documentation."""
    templates = list((Path(authoring.__file__).parent / "templates").glob("rule.*"))
    assert templates
    assert all(SCAFFOLD in template.read_text() for template in templates)


def test_bodies_that_are_hard_to_compare() -> None:
    """A search for a renaming with too many possibilities stops; a clique of eight is not part of one of seven."""
    eight, seven = (
        " . ".join(f"?x{one} :p ?x{other}" for one, other in permutations(range(size), 2)) for size in (8, 7)
    )
    wide, narrow = (
        read_text(f"PREFIX : <{EX}> CONSTRUCT {{ ?a :h ?a }} WHERE {{ ?a :k ?a . {body} }}", Path("a/b.rq"), "a/b")
        for body in (eight, seven)
    )
    assert not subsumes(wide.rules[0], narrow.rules[0])
    assert subsumes(narrow.rules[0], narrow.rules[0])


def test_a_store_that_does_not_answer() -> None:
    """A query that takes the store too long is a note; checks without a store still report."""
    store: Any = _Endless()
    path = FOLDER / "KG218" / "nothing.rq"
    given = replace(context(path), store=store, seconds=0.01)
    found = {finding.code: finding for finding in check_file(given.rules.files[0], given)}
    store.answer.set()
    assert (found["KG205"].severity, "did not answer in 0.01 s" in found["KG205"].message) == ("note", True)
    assert "KG218" in found


def test_a_store_that_is_empty() -> None:
    """An empty store has no match for an atom."""
    store = nothing(Vocabulary(NamedNode(EX + "inferred")))
    rule = read_text(OTHERS, Path("a/b.rq"), "a/b").rules[0]
    assert not store.matches(rule.body)
    assert store.failing(rule.body) == rule.body[0]
