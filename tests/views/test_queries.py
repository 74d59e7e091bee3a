"""Tests of the views that help with queries: stored ones, completion, diagnosis, cells of results."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from kg.errors import KgError, QueryError, RuleError, UsageError
from kg.syntax.names import PREFIXES
from kg.views.cells import cells
from kg.views.complete import complete, diagnose, prefixes
from kg.views.stored import stored
from kg.views.why import why_row

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

NODE = "https://w3id.org/rnkg/node/local/examples/rover_robot/scan_filter"
PUBLISHES = "<https://w3id.org/rnkg/ns#publishes>"
TOPIC = "<https://w3id.org/rnkg/topic/scan_filtered>"
NAME = "<https://w3id.org/rnkg/ns#name>"


def test_stored_queries_are_listed(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Without a name all stored queries are returned, with the parameters for a form."""
    found = {each["query"]: each for each in stored(snapshot, settings)["queries"]}
    (parameter,) = found["explore/who-publishes"]["parameters"]
    assert (parameter["name"], parameter["type"], parameter["example"]) == ("topic", "name", "/emergency_stop")
    assert found["explore/who-publishes"]["title"] == "Publishers of a topic"


@pytest.mark.parametrize("values", ['{"topic": "cmd_vel"}', {"topic": "cmd_vel"}])
def test_a_stored_query_takes_values(
    snapshot: EmbeddedSnapshot, settings: Settings, values: str | dict[str, str]
) -> None:
    """A named query is returned with its values inserted; empty ones are omitted."""
    assert 'VALUES ?topic { "/cmd_vel" }' in stored(snapshot, settings, "who-publishes", values)["bound"]
    assert "VALUES ?topic { UNDEF }" in stored(snapshot, settings, "who-publishes", {"topic": ""})["bound"]


def test_values_that_do_not_fit(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Values other than a JSON object of texts, or for an unknown parameter, are rejected with the reason."""
    for values in ("{", "[]", '{"topic": 1}'):
        with pytest.raises(UsageError, match="JSON"):
            stored(snapshot, settings, "who-publishes", values)
    with pytest.raises(QueryError, match="has no parameter `topc`"):
        stored(snapshot, settings, "who-publishes", {"topc": "/scan"})


def test_prefixes_are_those_of_queries_and_of_the_store(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """IRIs are shortened by the prefixes known to every query, whatever the store declares."""
    found = prefixes(snapshot, settings)
    assert found.items() >= PREFIXES.items()
    assert all(iri.startswith(("http", "urn")) for iri in found.values())


@pytest.mark.parametrize("as_text", [True, False])
def test_a_row_rests_on_facts(snapshot: EmbeddedSnapshot, settings: Settings, *, as_text: bool) -> None:
    """A row, also in JSON, has the facts matched by its query."""
    row = {"t": TOPIC}
    query = f"SELECT ?t {{ <{NODE}> rnkg:publishes ?t FILTER(isIRI(?t)) }}"
    found = why_row(snapshot, settings, query=query, row=json.dumps(row) if as_text else row)
    assert found["row"] == [{"name": "t", "term": TOPIC, "label": "/scan_filtered", "short": TOPIC}]
    assert [one["text"] for one in found["proofs"]] == ["scan_filter rnkg:publishes /scan_filtered"]
    assert len(found["conditions"]) == 1
    for wrong in ("[]", '{"t": 1}', "{"):
        with pytest.raises(UsageError, match="not a JSON object"):
            why_row(snapshot, settings, query=query, row=wrong)


def test_a_row_of_an_inner_query_is_not_traced_back(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A row of an inner SELECT has no facts, and the message is about the row, not a rule."""
    query = "SELECT ?n { { SELECT ?n (COUNT(?t) AS ?many) { ?n rnkg:publishes ?t } GROUP BY ?n } ?n a rnkg:NodeType }"
    with pytest.raises(RuleError, match="cannot be traced back"):
        why_row(snapshot, settings, query=query, row={"n": f"<{NODE}>"})


@pytest.mark.parametrize(
    "query",
    [
        "SELECT ?n (COUNT(?t) AS ?many) { ?n rnkg:publishes|rnkg:subscribes ?t } GROUP BY ?n",
        "SELECT DISTINCT ?n { ?n rnkg:publishes|rnkg:subscribes ?t }",
        "SELECT DISTINCT ?n (EXISTS { ?n a ?x } AS ?is) { { ?n rnkg:publishes ?t } UNION { ?n rnkg:subscribes ?t } }",
    ],
)
def test_a_row_of_many_solutions_says_so(snapshot: EmbeddedSnapshot, settings: Settings, query: str) -> None:
    """A grouped or distinct row has the facts of one solution, and the number of solutions."""
    found = why_row(snapshot, settings, query=query, row={"n": f"<{NODE}>", "many": '"7"'})
    assert len(found["proofs"]) == 1
    topics: Any = snapshot.query(f"SELECT ?t {{ <{NODE}> rnkg:publishes|rnkg:subscribes ?t }}", prefixes=PREFIXES)
    assert found["remark"] == f"this is one of {len(list(topics))} solutions that make the row"
    alone = why_row(snapshot, settings, query=query, row={"n": f"<{NODE}>", "t": TOPIC})
    assert alone["remark"] is None


def test_more_solutions_than_anybody_reads_are_not_counted(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Counting stops at a limit, so a row of the whole store is explained as fast as any other."""
    found = why_row(snapshot, settings, query="SELECT (COUNT(*) AS ?n) { ?s ?p ?o }", row={"n": '"9"'})
    assert found["remark"] == "this is one of 1,000 or more solutions that make the row"


@pytest.mark.parametrize(
    ("query", "code"),
    [
        ("SELECT ?s", "KG201"),
        ("SELECT ?s {", "KG201"),
        ("ASK { ?s ?p ?o }", "KG201"),
        ("SELECT ?s { ?s ?p ?o SERVICE <urn:x> { ?s ?p ?o } }", "KG502"),
        (f"SELECT ?s {{ ?s ?p ?o FILTER({'1 + ' * 10_000}1) }}", "KG516"),
    ],
)
def test_queries_that_no_row_is_of(snapshot: EmbeddedSnapshot, settings: Settings, query: str, code: str) -> None:
    """An incomplete SELECT query, or one that would crash the engine, is rejected before execution."""
    with pytest.raises(KgError) as refused:
        why_row(snapshot, settings, query=query, row={})
    assert refused.value.code == code


def test_completion_counts_once_and_keeps_it(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Positions are numbers or texts; the counts are stored in the cache of the store."""
    text = "ASK { ?x a rnkg:NodeTyp"
    found = complete(snapshot, settings, text, str(len(text)), fresh="yes")
    assert found["items"][0]["insert"] == "rnkg:NodeType"
    assert found["snapshot"] == snapshot.identity
    assert found["ready"]
    assert complete(snapshot, settings, text) == found
    assert isinstance(settings.store, Path)
    assert list(settings.store.glob("cache/completion-*/*/statistics.json"))
    with pytest.raises(UsageError, match="not a number"):
        complete(snapshot, settings, text, "here")


def test_diagnosis_knows_terms_that_are_only_used(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Suggestions include terms that the store only uses, not just those that it defines."""
    complete(snapshot, settings, "", fresh="yes")
    (problem,) = diagnose(snapshot, settings, "ASK { ?x rdfs:labell ?y }")["problems"]
    assert problem["hint"] == "Did you mean `rdfs:label`?"


def test_cells_tell_what_is_inferred_where_lines_are_and_which_are_nodes(
    snapshot: EmbeddedSnapshot, settings: Settings
) -> None:
    """Derived triples, source places and nodes are distinguished, in the order of the request."""
    triples = [[f"<{NODE}>", PUBLISHES, TOPIC], [f"<{NODE}>", NAME, '"scan_filter"'], ["_:x", PUBLISHES, TOPIC]]
    files = [["rover_robot/src/scan_filter.cpp", "12"], ["no/such/file.cpp", "1"]]
    paths = [row[0].value for row in snapshot.query(f"SELECT ?p {{ <{NODE}> <https://w3id.org/rnkg/ns#path> ?p }}")]  # type: ignore[union-attr] # rows of a SELECT
    files[0][0] = paths[0]
    found = cells(snapshot, settings, triples=json.dumps(triples), places=files, iris=[NODE, TOPIC[1:-1]])
    assert found["inferred"] == [True, False, False]
    first, missing = found["places"]
    assert (first["path"], first["line"], missing) == (paths[0], 12, None)
    assert found["nodes"] == [True, False]


def test_cells_tell_what_things_are_called_and_are(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """An entity has its label and its classes; one unknown to the store has neither."""
    node, topic, unknown = cells(snapshot, settings, things=[NODE, TOPIC[1:-1], "urn:x"])["things"]
    assert (node["label"], topic["label"]) == ("scan_filter", "/scan_filtered")
    assert PREFIXES["rnkg"] + "NodeType" in node["types"]
    assert unknown == {"label": None, "types": []}
    with pytest.raises(UsageError, match="is not an IRI"):
        cells(snapshot, settings, things=["no iri"])


@pytest.mark.parametrize("triples", ["{", '"a"', [["a"]], [["<a:b>", "c", "<d:e>"]]])
def test_cells_that_are_none(snapshot: EmbeddedSnapshot, settings: Settings, triples: str | list[list[str]]) -> None:
    """A request other than a list of terms is rejected."""
    with pytest.raises(UsageError):
        cells(snapshot, settings, triples=triples)
