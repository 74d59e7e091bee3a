"""Tests of refused updates, and of the places of their errors."""

from __future__ import annotations

import re

import pytest

from kg.errors import QueryError
from kg.pipeline.updating.checking import parsed

S, P = "<urn:test:s>", "<urn:test:p>"
DEEP = f"INSERT DATA {{ {S} {P} {'(' * 600}{')' * 600} }}"


@pytest.mark.parametrize(
    ("text", "line", "column"),
    [
        (f"INSERT DATA {{ {S} {P} }}", 1, 41),
        (f"INSERT DATA {{ {S} {P} 1 }} ;\nPREFIX x: <urn:x:>\nINSERT DATA {{ x:a x:b ?c }}", 3, 23),
        (f"INSERT DATA {{ {S} {P} 1 }} ;\nPREFIX x: <urn:x:>\nINSERT DATA {{ x:a y:b 1 }}", 3, 19),
        (f"INSERT DATA {{ {S} {P} _:c }} ;\nPREFIX x: <urn:x:>\nINSERT DATA {{ x:a x:b _:c }}", 3, 23),
        ("SELECT * {}", 1, 1),
        ("INSRT DATA {}", 1, 1),
        ("INSERT DATA {} CLEAR ALL", 1, 16),
        (f"INSERT {{ {S} {P} 1 }}", 1, 39),
        (f"DELETE DATA {{ {S} {P} _:a }}", 1, 41),
        (f"INSERT DATA {{ GRAPH ?g {{ {S} {P} 1 }} }}", 1, 21),
        (f"DELETE {{ {S} {P} [] }} WHERE {{ }}", 1, 36),
        ("DELETE WHERE { ?s ?p 1 ; ?q _:a }", 1, 29),
        ("INSERT DATA { 1 <urn:p> 2 }", 1, 15),
        ("INSERT DATA { <a> <urn:p> 2 }", 1, 15),
        ("CLEAR", 1, 6),
    ],
)
def test_errors_of_syntax_have_a_place(text: str, line: int, column: int) -> None:
    """The line and the column are those of the original text, also after other operations."""
    with pytest.raises(QueryError) as caught:
        parsed(text, "update", None)
    place = caught.value.place
    assert caught.value.code == "KG501"
    assert place is not None
    assert (place.line, place.column) == (line, column)
    assert place.excerpt == text.split("\n")[line - 1]


@pytest.mark.parametrize(
    "text",
    [
        "CLEAR ALL ; LOAD <http://127.0.0.1/>",
        "CLEAR ALL ; load silent <http://127.0.0.1/> INTO GRAPH <urn:test:g>",
        "PREFIX a: <urn:a:> LOAD a:b",
        "INSERT {} WHERE { SERVICE <http://127.0.0.1/> {} }",
        "INSERT {} WHERE { { SELECT * { service?x {} } } }",
        "DELETE {} WHERE { OPTIONAL { SERVICE # comment\n SILENT ?x {} } }",
        DEEP,
        f"DELETE WHERE {{ {'{' * 600}{'}' * 600} }}",
        f"INSERT {{}} WHERE {{ FILTER({'!' * 600}true) }}",
        f"INSERT {{}} WHERE {{ FILTER(1{' + 1' * 6000} = 1) }}",
    ],
)
def test_what_would_harm_is_refused(text: str) -> None:
    """Calls of other servers, nesting and chains that are too deep for the engine are refused."""
    with pytest.raises(QueryError) as caught:
        parsed(text, "update", None)
    assert caught.value.code == ("KG502" if re.search("SERVICE|LOAD", text, re.IGNORECASE) else "KG516")


@pytest.mark.parametrize(
    "text",
    [
        f'INSERT DATA {{ {S} {P} "LOAD <http://127.0.0.1/>" }} # SERVICE <x> {{}}',
        "PREFIX load: <urn:load:> INSERT DATA { load:a load:SERVICE load:b }",
        "PREFIX load: <urn:load:> WITH load:g DELETE { ?SERVICE ?p ?o } USING load:x WHERE { ?SERVICE ?p ?o }",
        "",
        "PREFIX x: <urn:x:>",
        "CLEAR ALL ; PREFIX x: <urn:x:>",
        f"INSERT DATA {{ {S} {P} {', '.join(f'-{number}' for number in range(8000))} }}",
        f"INSERT DATA {{ {' '.join(f'GRAPH <urn:g:{number}> {{ {S} {P} 1 }}' for number in range(8000))} }}",
        "DELETE WHERE { ?s ?p 1 } ;" * 8000,
    ],
)
def test_what_does_no_harm_passes(text: str) -> None:
    """Words in strings, comments and names, declarations alone, large data and many operations are accepted."""
    parsed(text, "update", None)
