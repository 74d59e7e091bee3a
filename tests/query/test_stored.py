"""Tests of stored queries: each returns the rows in a file, and its header is correct."""

from __future__ import annotations

import csv
import os
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from pyoxigraph import Literal

from kg import resources
from kg.errors import QueryError, UsageError
from kg.query.core import ask, row, suggestion
from kg.query.result import Solutions
from kg.query.stored import discover, find, internal, read
from kg.syntax.lexer import Kind, tokens

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.store.snapshot import EmbeddedSnapshot

EXPECTED = Path(__file__).parent / "expected"
QUERIES = {name: query for name, query in discover().items() if not name.startswith("demo/")}
FILES = sorted(resources.folder("queries").rglob("*.rq"))
VARYING = {"commit", "dirty"}
"""Differences between a checkout and an installation."""


def _example(name: str) -> dict[str, str]:
    """Return the example of the first parameter of a query, if any."""
    return {parameter.name: parameter.example for parameter in QUERIES[name].parameters[:1]}


def _table(result: Solutions) -> list[list[str]]:
    columns = [index for index, name in enumerate(result.variables) if name not in VARYING]
    rows = [[str(getattr(row[index], "value", "")) for index in columns] for row in result.rows]
    return [[result.variables[index] for index in columns], *rows]


@pytest.mark.parametrize("name", QUERIES)
def test_rows(examples: EmbeddedSnapshot, name: str) -> None:
    """The query returns the rows of its file, at least one; KG_WRITE_EXPECTED=1 rewrites the files."""
    values = _example(name)
    result = ask(examples, QUERIES[name], values)
    assert isinstance(result, Solutions)
    table = _table(result)
    path = EXPECTED / f"{name}.csv"
    if os.environ.get("KG_WRITE_EXPECTED"):
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows(table)
    with path.open(newline="", encoding="utf-8") as file:
        expected = list(csv.reader(file))
    # Queries about references find none in this store; tests/evaluate runs them with references.
    assert len(expected) > 1 or "/reference-" in name
    assert table == expected


@pytest.mark.parametrize("name", [name for name, query in QUERIES.items() if query.parameters])
def test_examples_restrict(examples: EmbeddedSnapshot, name: str) -> None:
    """With the example's value, the query returns a proper subset of the rows without it."""
    whole, part = ask(examples, QUERIES[name], {}), ask(examples, QUERIES[name], _example(name))
    assert isinstance(whole, Solutions)
    assert isinstance(part, Solutions)
    assert 0 < len(part.rows) < len(whole.rows)
    assert set(part.rows) <= set(whole.rows)


@pytest.mark.parametrize("name", QUERIES)
def test_headers(name: str) -> None:
    """Each query has a title and a description."""
    assert QUERIES[name].title != name


def test_every_expectation_has_its_query() -> None:
    """Every file of expected rows belongs to a query."""
    assert {path.relative_to(EXPECTED).with_suffix("").as_posix() for path in EXPECTED.rglob("*.csv")} == set(QUERIES)


def test_names_with_or_without_slash(examples: EmbeddedSnapshot) -> None:
    """A ROS name is found without its leading slash."""
    query = find("who-publishes")
    with_slash, without = (ask(examples, query, {"topic": name}) for name in ("/odom", "odom"))
    assert isinstance(with_slash, Solutions)
    assert isinstance(without, Solutions)
    assert with_slash.rows == without.rows


def test_find_by_last_part_and_by_guess() -> None:
    """The last part of a name is enough, and a misspelt name gets a suggestion."""
    assert find("who-publishes") is not None
    assert find("explore/who-publishes").name == "explore/who-publishes"
    with pytest.raises(UsageError) as caught:
        find("who-publish")
    assert caught.value.code == "KG001"
    assert "who-publishes" in (caught.value.hint or "")


def test_folders_of_users(tmp_path: Path) -> None:
    """Queries of a user's folder are found together with those of kg, and take precedence."""
    (tmp_path / "mine.rq").write_text("# Mine\nSELECT * { ?s ?p ?o }\n")
    (tmp_path / "explore").mkdir()
    (tmp_path / "explore" / "topics.rq").write_text("# My topics\nASK { ?s ?p ?o }\n")
    found = discover([tmp_path])
    assert found["mine"].title == "Mine"
    assert found["explore/topics"].title == "My topics"
    assert set(found) >= set(QUERIES)


def test_unknown_parameter() -> None:
    """An unknown parameter is KG505 with the known ones."""
    with pytest.raises(QueryError) as caught:
        find("who-publishes").bind({"topik": "/scan"})
    assert caught.value.code == "KG505"
    assert "`topic`" in (caught.value.hint or "")


@pytest.mark.parametrize(
    ("kind", "good", "bad"), [("integer", "7", "seven"), ("boolean", "yes", "maybe"), ("iri", "urn:a", "no iri")]
)
def test_values_have_types(tmp_path: Path, kind: str, good: str, bad: str) -> None:
    """A value that does not have its parameter's type is KG505 with the example."""
    path = tmp_path / "q.rq"
    path.write_text(f'# T\n# @param x {kind} "{good}" a value\nSELECT ?x {{ VALUES ?x {{ UNDEF }} }}\n')
    query = read(path, "q")
    assert query.bind({"x": good})
    with pytest.raises(QueryError) as caught:
        query.bind({"x": bad})
    assert caught.value.code == "KG505"
    assert good in (caught.value.hint or "")


@pytest.mark.parametrize(
    ("word", "value"),
    [("true", True), ("Yes", True), ("1", True), ("false", False), ("NO", False), ("0", False)],
)
def test_truth_values_have_several_words(tmp_path: Path, word: str, value: bool) -> None:  # noqa: FBT001 - a column
    """Words in any case and digits are truth values."""
    path = tmp_path / "q.rq"
    path.write_text('# T\n# @param x boolean "yes" a value\nSELECT ?x { VALUES ?x { UNDEF } }\n')
    assert read(path, "q").bind({"x": word}) == {"x": Literal(value)}


@pytest.mark.parametrize(
    "text", ["# T\n# @param x\nSELECT ?x { VALUES ?x { UNDEF } }", '# T\n# @param y string "" a value\nSELECT ?x { }']
)
def test_wrong_headers_have_a_place(tmp_path: Path, text: str) -> None:
    """A header that describes no parameter, or an unknown one, is reported with file and line."""
    path = tmp_path / "q.rq"
    path.write_text(text)
    with pytest.raises(QueryError) as caught:
        read(path, "q")
    assert caught.value.place is not None
    assert (caught.value.place.path, caught.value.place.line) == (str(path), 2)


def test_suggestions(examples: EmbeddedSnapshot) -> None:
    """Similar values are suggested for a value missing from the store, and only then."""
    query = find("who-publishes")
    assert "`/scan_filtered`" in (suggestion(examples, query, {"topic": "/scan_filterd"}) or "")
    assert suggestion(examples, query, {"topic": "/scan_filtered"}) is None


def test_internal_queries_are_not_listed() -> None:
    """Internal queries are found by name, but not listed."""
    assert "SELECT" in internal("relations")
    assert not any(name.startswith("internal/") for name in QUERIES)
    assert (resources.folder("queries") / "internal").is_dir()


def test_one_row(examples: EmbeddedSnapshot) -> None:
    """A row of the result is selected by its number from one, and returned with the bound query."""
    query = find("who-publishes", ())
    every = ask(examples, query, {"topic": "/odom"})
    assert isinstance(every, Solutions)
    text, found = row(examples, query, {"topic": "/odom"}, len(every.rows))
    assert list(found.values()) == [term for term in every.rows[-1] if term is not None]
    assert '"/odom"' in text
    with pytest.raises(UsageError, match=f"not {len(every.rows) + 1}"):
        row(examples, query, {"topic": "/odom"}, len(every.rows) + 1)


def _behind_optional(text: str) -> Iterator[str]:
    """Yield the variables of patterns after an OPTIONAL in its group; those in brackets belong to expressions."""
    groups, brackets, before = [False], 0, ""
    openers: list[str] = []
    for token in tokens(text):
        word = token.text.upper()
        if word == "{":
            openers.append(before)
            groups.append(False)
        elif word == "}":
            groups.pop()
            groups[-1] |= openers.pop() == "OPTIONAL"
        elif word in {"(", ")"}:
            brackets += 1 if word == "(" else -1
        elif token.kind is Kind.VARIABLE and groups[-1] and not brackets and before != "VALUES":
            yield token.text
        before = before if before == "VALUES" and token.kind is Kind.VARIABLE else word


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_what_is_optional_stands_last(path: Path) -> None:
    """No pattern follows an OPTIONAL: the engine would evaluate it for the whole store, whatever came before."""
    assert not list(_behind_optional(path.read_text("utf-8")))


def test_patterns_behind_what_is_optional_are_found() -> None:
    """The check finds a pattern after an OPTIONAL, and accepts conditions, data and other groups."""
    assert list(_behind_optional("SELECT * { ?a ?b ?c OPTIONAL { ?a ?d ?e } ?f ?g 1 }")) == ["?f", "?g"]
    assert not list(_behind_optional("SELECT * { { ?a a 1 OPTIONAL { ?a a 2 } } ?b a 3 . OPTIONAL { ?b a 4 } }"))
    assert not list(_behind_optional("SELECT * { OPTIONAL { ?a a 1 } FILTER(?a = 1) VALUES ?a { 1 } } ORDER BY ?a"))
