"""Tests of content negotiation, C6."""

from __future__ import annotations

from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.server.errors import RequestError
from kg.server.negotiation import GRAPH, RESULTS, Choice, best, choose, prefers_pages, ranges

BROWSER = "text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8"
TYPES = sorted({media_type for media_type, _ in (*RESULTS, *GRAPH)})


@pytest.mark.parametrize(
    ("accept", "rows", "graph"),
    [
        (None, "application/sparql-results+json", "text/turtle"),
        ("", "application/sparql-results+json", "text/turtle"),
        ("*/*", "application/sparql-results+json", "text/turtle"),
        ("text/csv", "text/csv", None),
        ("text/turtle; charset=utf-8", None, "text/turtle"),
        ("application/n-triples", None, "application/n-triples"),
        ("application/json", "application/json", "application/json"),
        ("application/*", "application/sparql-results+json", "application/n-triples"),
        ("text/*", "text/csv", "text/turtle"),
        ("text/csv, */*", "text/csv", "text/turtle"),
        ("*/*, text/csv", "text/csv", "text/turtle"),
        ("text/csv;q=0.5, application/sparql-results+xml;q=0.8", "application/sparql-results+xml", None),
        ("application/sparql-results+json;q=0, */*", "application/json", "text/turtle"),
        ("text/*;q=0.9, text/csv;q=0, */*;q=0.1", "text/tab-separated-values", "text/turtle"),
        ("text/csv;charset=utf-16, */*;q=0.1", "application/sparql-results+json", "text/turtle"),
        ('text/csv;header="present, or not"', "text/csv", None),
        ("TEXT/CSV", "text/csv", None),
        ("text/n3", None, "text/n3"),
        ("text/csv;q=2, text/tab-separated-values", "text/tab-separated-values", None),
        ("no media type", "application/sparql-results+json", "text/turtle"),
        ("application/sparql-results+xml,application/sparql-results+json", "application/sparql-results+xml", None),
        (BROWSER, "application/xml", "application/xml"),
    ],
)
def test_table(accept: str | None, rows: str | None, graph: str | None) -> None:
    """Each header gives its type for rows and for graphs, or none for one of them."""
    found = choose(accept)
    assert (found.get("rows") and found["rows"].media_type) == rows
    assert (found.get("graph") and found["graph"].media_type) == graph
    assert found.get("boolean") == found.get("rows")


@pytest.mark.parametrize("accept", ["image/png", "*/*;q=0", "text/csv;q=0.0", "application/pdf, image/*"])
def test_nothing_acceptable(accept: str) -> None:
    """A client that accepts no available format gets the list of them."""
    with pytest.raises(RequestError) as refused:
        choose(accept)
    assert refused.value.code == "KG523"
    assert "text/csv" in (refused.value.hint or "")


@pytest.mark.parametrize(
    ("name", "rows", "graph"),
    [
        ("json", "json", "jsonld"),
        ("xml", "xml", "rdfxml"),
        ("csv", "csv", None),
        ("TTL", None, "turtle"),
        ("nt", None, "ntriples"),
        ("jsonld", "json", "jsonld"),
        ("text/csv", "csv", None),
        ("application/sparql-results+xml", "xml", None),
        ("rdf+xml", "xml", "rdfxml"),
        ("n3", None, "turtle"),
    ],
)
def test_names(name: str, rows: str | None, graph: str | None) -> None:
    """A name in a link wins over the header, and selects the matching format of each kind of response."""
    found = choose("image/png", (name,))
    assert (found.get("rows") and found["rows"].format) == rows
    assert (found.get("graph") and found["graph"].format) == graph


@pytest.mark.parametrize("name", ["jsn", "application/pdf", "a/b/c"])
@pytest.mark.parametrize("accept", [None, "*/*"])
def test_unknown_name(name: str, accept: str | None) -> None:
    """An unknown format name is rejected if the client accepts anything else."""
    with pytest.raises(RequestError, match="unknown format"):
        choose(accept, (name,))


@pytest.mark.parametrize("named", [("tsv", "csv"), ("jsn", "tsv"), ("a/b", "", "tsv"), ("jsn",), ("a/b", "")])
def test_the_first_known_name_counts(named: tuple[str, ...]) -> None:
    """Unknown format names are ignored if another one or the header gives an accepted format."""
    assert choose("text/tab-separated-values", named)["rows"].format == "tsv"


def test_pages() -> None:
    """Browsers that follow a link get a page; programs that list HTML last do not."""
    assert prefers_pages(BROWSER)
    assert not prefers_pages("*/*")
    assert not prefers_pages("text/html;q=0.1, text/csv")
    assert not prefers_pages("text/html;q=0")


def test_content_type() -> None:
    """Text declares its encoding; JSON, with its single one, does not."""
    assert Choice("csv", "text/csv").content_type == "text/csv; charset=utf-8"
    assert Choice("json", "application/json").content_type == "application/json"


QUALITIES = st.integers(0, 1000).map(lambda number: number / 1000)
HEADERS = st.lists(
    st.tuples(st.sampled_from([*TYPES, "*/*", "text/*", "application/*", "image/png"]), QUALITIES),
    min_size=1,
    max_size=6,
)


@given(HEADERS)
def test_quality_decides(header: list[tuple[str, float]]) -> None:
    """The chosen type has the highest quality, and one above zero."""
    accept = ranges(", ".join(f"{name};q={quality:.3f}" for name, quality in header))

    def quality(media_type: str) -> float:
        fitting = [(one.precision(media_type), -index) for index, one in enumerate(accept)]
        precision, order = max(fitting)
        return accept[-order].quality if precision else 0.0

    for offered in (RESULTS, GRAPH):
        found = best(accept, offered)
        most = max(quality(media_type) for media_type, _ in offered)
        assert (found is None) == (most == 0)
        assert found is None or quality(found.media_type) == most


@given(st.text(max_size=80))
def test_any_header(header: str) -> None:
    """Any text gives a choice, or is rejected as a bad request."""
    with suppress(RequestError):
        assert choose(header)


@given(st.text(alphabet='text/csv;q=01.", *application\\ ', max_size=60))
def test_almost_headers(header: str) -> None:
    """Header-like text is parsed without error, and no quality is out of bounds."""
    assert all(0 <= found.quality <= 1 for found in ranges(header))
