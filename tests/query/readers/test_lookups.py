"""Tests of look-ups: which queries count, and whether the server's own process answers them as readers do."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st
from patience import patient
from pyoxigraph import NamedNode
from query.readers.asking import ENDLESS, outcome, question, until
from query.readers.conftest import EX

from kg.query.evaluation import prepare
from kg.query.readers.lookups import is_look_up
from kg.query.readers.messages import frame
from kg.query.readers.pool import Readers

if TYPE_CHECKING:
    from kg.query.readers.cache import CachedResponse
    from kg.query.readers.messages import Question
    from kg.store.embedded import EmbeddedStore
    from kg.store.layout import Layout

pytestmark = pytest.mark.usefixtures("forked")

LOOK_UPS = [
    f"SELECT ?p ?o WHERE {{ <{EX}1> ?p ?o }} LIMIT 10",
    f"select * {{ <{EX}1> ?p $o. }}\n# a comment",
    f"ASK {{ <{EX}1> <{EX}p> <{EX}2> }}",
    f"ASK WHERE {{ <{EX}1> <{EX}p> <{EX}3> }}",
    f"PREFIX ex: <{EX}> # a comment {{\nPREFIX other: <{EX}x#>\nSELECT ?n {{ ex:h ex:only ?n }}",
    f'SELECT ?s {{ ?s <{EX}label> "thing 7"@en }}',
    f'SELECT ?s {{ ?s <{EX}number> "7"^^<http://www.w3.org/2001/XMLSchema#integer> }}',
    f'SELECT ?s {{ ?s <{EX}number> "7"^^xsd:integer }}',
    "SELECT * { ?s ?p ?o } LIMIT 100",
    "ASK { ?s a ?type }",
    f"SELECT ?o {{ <{EX}none> ?p ?o }} LIMIT 0",
]
OTHERS = [
    "SELECT DISTINCT ?o { ?s ?p ?o } LIMIT 1",
    "SELECT ?o { ?s ?p ?o } ORDER BY ?o LIMIT 1",
    "SELECT ?o { ?s ?p ?o } LIMIT 1 OFFSET 1000000000",
    "SELECT (COUNT(*) AS ?n) { ?s ?p ?o }",
    "SELECT ?o { ?s ?p ?o . ?o ?q ?r } LIMIT 1",
    "SELECT ?o { ?s ?p ?o ; ?q ?r } LIMIT 1",
    "SELECT ?o { ?s ?p ?o , ?r } LIMIT 1",
    "SELECT ?o { ?s <p>/<q> ?o } LIMIT 1",
    "SELECT ?o { ?s <p>* ?o } LIMIT 1",
    "SELECT ?s { ?s ?p ?s } LIMIT 1",
    "SELECT ?s { ?s ?p $s } LIMIT 1",
    "SELECT ?o { ?s ?p ?o FILTER(?o = 1) } LIMIT 1",
    "SELECT ?o FROM <g> { ?s ?p ?o } LIMIT 1",
    "SELECT ?o { GRAPH ?g { ?s ?p ?o } } LIMIT 1",
    "SELECT ?o { SERVICE <http://127.0.0.1/> { ?s ?p ?o } } LIMIT 1",
    "SELECT ?o { ?s ?p << ?a ?b ?o >> } LIMIT 1",
    "SELECT ?o { ?s ?p (?o) } LIMIT 1",
    "SELECT ?o { ?s ?p [ ?q ?o ] } LIMIT 1",
    "SELECT ?o { ?s ?p ?o } GROUP BY ?o LIMIT 1",
    "SELECT ?o { ?s ?p ?o } LIMIT 1 VALUES ?o { 1 }",
    "SELECT ?o { ?s \\u0061 ?o } LIMIT 1",
    'ASK { ?s ?p """x""" }',
    "CONSTRUCT { ?s ?p ?o } WHERE { ?s ?p ?o } LIMIT 1",
    "DESCRIBE <x>",
    "ASK {}",
    "",
    "ASK { ?s ?p ?o }" + " " * 3000,
]


@pytest.mark.parametrize("text", LOOK_UPS)
def test_one_pattern_is_a_look_up(text: str) -> None:
    """A query with one pattern is a look-up, also with prefixes, comments and a LIMIT."""
    assert is_look_up(text)


@pytest.mark.parametrize("text", OTHERS)
def test_what_may_take_long_is_no_look_up(text: str) -> None:
    """Queries that read more than they return do not count: joins, paths, filters, orders, groups, other datasets."""
    assert not is_look_up(text)


PIECES = (*" \n#.{}()<>\"'@^?$:*/|!;,[]", "ASK", "SELECT", "WHERE", "LIMIT 1", "PREFIX a: <b>", "?x", "?y", "$z", "<i>")
PIECES += (
    "a",
    "a:b",
    ":",
    '"l"',
    '"l"@en',
    "'s'",
    "FILTER",
    "UNION",
    "SERVICE",
    "LOAD",
    "GRAPH",
    "FROM",
    "\\u0022",
    "é",
)


@given(st.lists(st.sampled_from(PIECES), max_size=14), st.integers(0, 30))
def test_what_passes_for_a_look_up_passes_the_guard(pieces: list[str], where: int) -> None:
    """Whatever is inserted into a look-up: if it still counts, it has one pattern for the lexer too, and no call."""
    begun = ["SELECT", " ", "?x", " ", "{", " ", "?x", " ", "a:b", " ", "?y", " ", "}", " ", "LIMIT 1"]
    text = "".join((*begun[:where], *pieces, *begun[where:]))
    if is_look_up(text):
        prepared = prepare(text, {})
        assert prepared.repeatable
        assert not prepared.names_data


def look_up(readers: Readers, asked: Question) -> CachedResponse | None:
    """Look up as the endpoint does."""
    return readers.look_up(asked, frame(asked))


async def opened(readers: Readers) -> None:
    """Wait until look-ups work."""
    await until(lambda: look_up(readers, question("ASK { ?s ?p ?o }")))


def test_look_ups_have_the_answers_of_readers(layout: Layout) -> None:
    """Head, body and rows are the same, in every format."""

    async def ask() -> None:
        async with Readers(layout) as readers:
            await opened(readers)
            for text in LOOK_UPS:
                for name in ("json", "xml", "csv", "tsv", "markdown", "jsonl"):
                    asked = question(text, {"rows": name, "boolean": name}, base="http://127.0.0.1/sparql")
                    found = look_up(readers, asked)
                    assert found is not None
                    async with readers.ask(asked, seconds=patient(20)) as answer:
                        body = b"".join([part async for part in answer.parts()])
                        assert answer.end is not None
                        assert (found.head, found.end.rows, found.end.more) == (
                            answer.head,
                            answer.end.rows,
                            answer.end.more,
                        )
                    assert found.body == body

    asyncio.run(ask())


LEFT = [
    question("SELECT * { ?s ?p ?o }"),
    question("SELECT * { ?s ?p ?o } LIMIT 257"),
    question("SELECT * { ?s ?p ?o } LIMIT 20", rows=10),
    question("SELECT * { ?s ?p ?o } LIMIT 20", size=100),
    question("SELECT * { ?s ?p ?o } LIMIT 20", offset=1),
    question("SELECT * { ?s ?p ?o } LIMIT 20", snapshot="1000"),
    question("SELECT * { ?s ?p ?o } LIMIT 20", parameters={"s": f"<{EX}1>"}),
    question("SELECT * { ?s ?p ?o } LIMIT 20", default_graphs=(EX + "g",)),
    question("SELECT * { ?s ?p ?o } LIMIT 20", {"graph": "turtle"}),
    question("SELECT * { ?s ?p ?o } LIMIT 20", {"rows": "parquet"}),
    question("SELECT * { ?s unknown:p ?o } LIMIT 20"),
    question("SELECT * { ?s <relative> ?o } LIMIT 20"),
    question('SELECT * { "subject" ?p ?o } LIMIT 20'),
]


@pytest.mark.parametrize("asked", LEFT, ids=lambda asked: asked.text)
def test_readers_answer_the_rest(layout: Layout, asked: Question) -> None:
    """Readers answer many rows, limits that are reached, other datasets and errors."""

    async def ask() -> None:
        async with Readers(layout) as readers:
            await opened(readers)
            assert look_up(readers, asked) is None

    asyncio.run(ask())


def test_large_terms_are_left_to_readers(fresh: EmbeddedStore) -> None:
    """The server's process holds no large terms for a look-up."""
    with fresh.write("test") as transaction:
        text = f'<{EX}s> <{EX}p> "{"x" * 100_000}" .\n<{EX}s> <{EX}q> "short" .\n'
        transaction.replace_graphs({NamedNode(EX + "large"): [text.encode()]})

    async def ask() -> None:
        async with Readers(fresh.layout) as readers:
            await opened(readers)
            assert look_up(readers, question(f"SELECT ?o {{ <{EX}s> <{EX}p> ?o }}")) is None
            assert look_up(readers, question(f"SELECT ?o {{ <{EX}s> <{EX}q> ?o }}")) is not None

    asyncio.run(ask())


def is_deleted(store: EmbeddedStore, generation: int) -> bool:
    """Let a writer delete what no reader holds, and return whether a generation is gone."""
    with store.write("test"):
        pass
    return generation not in store.layout.numbers()


def test_look_ups_follow_the_data(fresh: EmbeddedStore) -> None:
    """After a change no look-up reads the old data, which is released; soon the new data is used."""
    asked = question(f"ASK {{ <{EX}added> ?p ?o }}")

    async def ask() -> None:
        async with Readers(fresh.layout) as readers:
            await opened(readers)
            before = look_up(readers, asked)
            assert before is not None
            assert b"false" in before.body
            old = before.head.snapshot
            for number in range(2):
                with fresh.write("test") as transaction:
                    transaction.replace_graphs(
                        {NamedNode(f"{EX}new{number}"): [f"<{EX}added> <{EX}p> <{EX}C> .\n".encode()]}
                    )
                assert look_up(readers, asked) is None
                await opened(readers)
                after = look_up(readers, asked)
                assert after is not None
                assert after.head.snapshot == str(fresh.layout.current())
                assert b"true" in after.body
            await until(lambda: is_deleted(fresh, int(old)))
        assert look_up(readers, asked) is None

    asyncio.run(ask())


def test_look_ups_wait_for_nobody(layout: Layout) -> None:
    """While every reader is busy, a look-up is answered at once."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            await opened(readers)
            tasks = [asyncio.create_task(outcome(readers, f"{ENDLESS} # {n}", seconds=60)) for n in range(3)]
            await until(lambda: len(readers.jobs) == 3)
            assert look_up(readers, question(f"ASK {{ <{EX}1> ?p ?o }}")) is not None
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    asyncio.run(ask())
