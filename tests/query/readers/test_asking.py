"""Tests of the responses of readers."""

from __future__ import annotations

import asyncio
import json
from typing import TYPE_CHECKING, Any

import pytest
from patience import patient
from query.readers.asking import ALL, FORMATS, STREAM, outcome, question, whole

from kg.errors import KgError
from kg.query.readers.pool import Readers

if TYPE_CHECKING:
    from kg.store.layout import Layout

pytestmark = pytest.mark.usefixtures("forked")

EX = "https://example.org/"
GRAPHS = "SELECT DISTINCT ?g { GRAPH ?g { ?s ?p ?o } } ORDER BY ?g"


def answered(layout: Layout, text: str, **options: Any) -> tuple[Any, Any, Any]:
    """Return the head, the JSON and the end of one response."""

    async def ask() -> tuple[Any, Any, Any]:
        async with Readers(layout, processes=1) as readers:
            head, body, end = await whole(readers, text, **options)
            return head, json.loads(body), end

    return asyncio.run(ask())


def counts(layout: Layout, *asked: tuple[str, dict[str, Any]]) -> list[int]:
    """Return the number of rows for each question."""

    async def ask() -> list[int]:
        async with Readers(layout, processes=1) as readers:
            return [(await whole(readers, text, **options))[2].rows for text, options in asked]

    return asyncio.run(ask())


def test_forms_of_answers(layout: Layout) -> None:
    """Rows, booleans and graphs have the format requested for their kind, the snapshot and the number of rows."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            head, body, end = await whole(readers, "SELECT ?n { ?s <https://example.org/number> ?n }")
            assert (head.kind, head.format, head.snapshot, head.variables) == ("rows", "json", "1", ("n",))
            assert len(json.loads(body)["results"]["bindings"]) == end.rows == 250
            head, body, end = await whole(readers, "ASK {}")
            assert (head.kind, json.loads(body)["boolean"], end.rows) == ("boolean", True, 1)
            head, body, end = await whole(readers, "CONSTRUCT { ?s a ?o } { ?s <https://example.org/p> ?o }")
            assert (head.kind, body.count(b" .\n"), end.rows) == ("graph", 250, 250)
            formats = {"rows": "csv"}
            assert await outcome(readers, "ASK {}", formats=formats) == "KG504"

    asyncio.run(ask())


def test_row_cap_and_offset(layout: Layout) -> None:
    """C10: rows beyond the limit are left out and reported; exactly as many as the limit are not cut."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            for rows, offset, count, more in [
                (1001, 0, 1001, False),
                (1000, 0, 1000, True),
                (100, 950, 51, False),
                (51, 950, 51, False),
                (50, 950, 50, True),
                (None, 1001, 0, False),
                (0, 0, 0, True),
            ]:
                _, body, end = await whole(readers, ALL, rows=rows, offset=offset)
                assert (end.rows, end.more) == (count, more)
                assert len(json.loads(body)["results"]["bindings"]) == count
            formats = {"graph": "ntriples"}
            _, body, end = await whole(readers, "CONSTRUCT WHERE { ?s ?p ?o }", rows=10, formats=formats)
            assert (end.rows, end.more, body.count(b"\n")) == (10, True, 10)

    asyncio.run(ask())


def test_pages_are_the_whole(layout: Layout) -> None:
    """The concatenated pages of a result are the result."""

    async def ask() -> None:
        async with Readers(layout, processes=2) as readers:
            formats = {"rows": "tsv"}
            _, body, _ = await whole(readers, ALL, formats=formats)
            pages = [
                await whole(readers, ALL, rows=300, offset=offset, formats=formats) for offset in range(0, 1001, 300)
            ]
            rows = [line for _, page, _ in pages for line in page.splitlines()[1:]]
            assert rows == body.splitlines()[1:]
            assert [end.more for _, _, end in pages] == [True, True, True, False]

    asyncio.run(ask())


def test_data_sets(layout: Layout) -> None:
    """Graphs in the request replace those of the query; without them FROM applies, else union or the unnamed graph."""
    clause = "SELECT * FROM <https://example.org/h> { ?s ?p ?o }"
    named = "SELECT DISTINCT ?g FROM NAMED <https://example.org/h> { GRAPH ?g { ?s ?p ?o } }"
    found = counts(
        layout,
        (ALL, {}),
        (ALL, {"union": False}),
        (clause, {}),
        (clause, {"union": False}),
        (clause.replace("FROM", "FROM NAMED"), {}),
        (named, {}),
        (ALL, {"default_graphs": (EX + "h",)}),
        (ALL, {"default_graphs": (EX + "h", EX + "g")}),
        (ALL, {"default_graphs": ()}),
        (ALL, {"named_graphs": (EX + "h",)}),
        (GRAPHS, {"named_graphs": (EX + "h",)}),
        (GRAPHS, {"default_graphs": (EX + "h",)}),
        (clause, {"default_graphs": (EX + "g",)}),
        (named, {"named_graphs": (EX + "g", EX + "h")}),
        (GRAPHS, {}),
    )
    assert found == [1001, 0, 1, 1, 0, 1, 1, 1001, 0, 0, 1, 0, 1000, 2, 2]


def test_bad_graphs_and_parameters(layout: Layout) -> None:
    """A graph that is not an IRI, or a value that is not an N-Triples term, is KG505."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            assert await outcome(readers, ALL, default_graphs=("no iri",)) == "KG505"
            for value in ("1", "x", "", "_:b", "<a:a> . <x:s> <x:p> <a:b>", '"open'):
                assert await outcome(readers, ALL, parameters={"o": value}) == "KG505", value
            _, body, _ = await whole(readers, "SELECT ?s { ?s ?p ?o }", parameters={"o": '"thing 7"@en'})
            assert json.loads(body)["results"]["bindings"] == [{"s": {"type": "uri", "value": EX + "7"}}]

    asyncio.run(ask())


def test_relative_iris(layout: Layout) -> None:
    """Relative IRIs are resolved against the base, and are errors without one."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            _, body, _ = await whole(readers, "SELECT ?o { <7> <number> ?o }", base=EX)
            assert json.loads(body)["results"]["bindings"][0]["o"]["value"] == "7"
            assert await outcome(readers, "SELECT ?o { <7> <number> ?o }") == "KG501"

    asyncio.run(ask())


def test_wanted_snapshot(layout: Layout) -> None:
    """C31: a question about a snapshot that is not current is KG512, never another result."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            assert await outcome(readers, ALL, snapshot="1") == "whole"
            for other in ("0", "2", "01", "", "x"):
                assert await outcome(readers, ALL, snapshot=other) == "KG512"

    asyncio.run(ask())


@pytest.mark.parametrize(
    ("text", "repeatable"),
    [
        ("SELECT ?s { ?s ?p ?o }", True),
        ("SELECT (NOW() AS ?x) {}", False),
        ("SELECT (rand() AS ?x) {}", False),
        ("SELECT (struuid() AS ?x) (1 AS ?y) {}", False),
        ("SELECT (BNODE() AS ?x) {}", False),
        ("ASK { FILTER(UUID() != <a:a>) }", False),
        ("SELECT ?now { ?now <https://example.org/rand> 'UUID()' } # NOW()", True),
    ],
)
def test_repeatable(layout: Layout, text: str, repeatable: bool) -> None:  # noqa: FBT001 - a case of the table
    """Results that differ each time are marked; the words in names, texts and comments do not count."""
    head, _, _ = answered(layout, text)
    assert head.repeatable is repeatable


@pytest.mark.parametrize("text", ["SELECT", "SELECT * { ?s ?p", "SELECT * { SERVICE <http://127.0.0.1:9/> {} }"])
def test_errors_have_their_place(layout: Layout, text: str) -> None:
    """C33: the error of a reader is that of the same query in this process, including place and hint."""

    async def ask() -> KgError:
        async with Readers(layout, processes=1) as readers:
            with pytest.raises(KgError) as caught:
                await whole(readers, text, path="here")
            return caught.value

    error = asyncio.run(ask())
    assert error.code in {"KG501", "KG502", "KG516"}
    assert error.place is not None
    assert error.place.path == "here"


def test_answers_stream_with_word_of_how_far_they_are(layout: Layout) -> None:
    """Parts arrive while rows are found, and the job contains their number."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            async with readers.ask(question(STREAM), seconds=patient(20), job="mine") as answer:
                assert answer.end is None
                sizes = []
                async for part in answer.parts():
                    sizes.append(len(part))
                    if len(sizes) > 40 and readers.jobs["mine"].rows:
                        break
            assert all(size < 1 << 20 for size in sizes)
            assert readers.jobs == {}

    asyncio.run(ask())


def test_quick_answers_are_whole_from_the_beginning(layout: Layout) -> None:
    """If `end` is set at once, `size` is the number of bytes."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers, readers.ask(question(ALL)) as answer:
            assert answer.end is not None
            assert answer.size == len(b"".join([part async for part in answer.parts()]))

    asyncio.run(ask())


def test_byte_cap(layout: Layout) -> None:
    """C10: a response larger than the limit is KG511; if it is small, before any part."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            _, body, _ = await whole(readers, ALL)
            assert await outcome(readers, ALL, size=len(body)) == "whole"
            assert await outcome(readers, ALL, size=len(body) - 1) == "KG511"
            for name in ("csv", "xml", "jsonl"):
                assert await outcome(readers, STREAM, size=3 << 20, formats={**FORMATS, "rows": name}) == "KG511"
            assert await outcome(readers, "ASK {}", size=3) == "KG511"

    asyncio.run(ask())


def test_views(layout: Layout) -> None:
    """Views run like queries; an unknown name or argument is an error of the caller."""

    async def ask() -> None:
        async with Readers(layout, processes=1, calls="kg.views.calls") as readers:
            with pytest.raises(KgError, match="KG506"):
                await readers.call("no-such-view", {})
            with pytest.raises(KgError, match="KG505"):
                await readers.call("diagnose", {"no_such_argument": 1})
            assert json.loads(await readers.call("diagnose", {"text": "SELECT * { ?s ?p ?o }"})) is not None

    asyncio.run(ask())
