"""Rules run on a SPARQL server give the same inferences as the embedded engine."""

from __future__ import annotations

import time
import urllib.request
from contextlib import contextmanager, suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread
from typing import TYPE_CHECKING

import pytest
from pyoxigraph import DefaultGraph, NamedNode, RdfFormat, serialize
from rules.forms import atom, expression, rule, rule_set, triples
from rules.forms import test as keep
from store.servers import append, oxigraph_server, virtuoso_server

from kg.errors import RuleError, StoreError
from kg.rules.engine.limits import Limits
from kg.rules.form import AUXILIARY, Aggregate, Assignment, Column, EngineBlock, Exists, Values, Variable
from kg.rules.remote import run
from kg.store.remote import RemoteStore

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from pyoxigraph import Triple

    from kg.rules.form import Rule
    from kg.rules.remote import RemoteReport

BASE = "https://example.org/graph/"
INFERRED = NamedNode(f"{BASE}inferred")
SOURCE = NamedNode(f"{BASE}source/a")


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """One server of Oxigraph for all tests of this file."""
    with oxigraph_server() as found:
        yield found


@pytest.fixture(scope="module", params=["oxigraph", pytest.param("virtuoso", marks=pytest.mark.virtuoso)])
def server(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[RemoteStore]:
    """One server of each kind for all tests of this file."""
    if request.param == "oxigraph":
        address = request.getfixturevalue("address")
        yield RemoteStore(f"{address}/query", f"{address}/update")
        return
    with virtuoso_server(tmp_path_factory.mktemp("virtuoso")) as found:
        yield RemoteStore(found)


@pytest.fixture
def store(server: RemoteStore) -> RemoteStore:
    """An empty server."""
    everything = " ;\n".join(f"DROP SILENT GRAPH {graph}" for graph in graphs(server))
    server.update("DROP ALL" if not is_virtuoso(server) else everything or "DROP SILENT GRAPH <urn:x:none>")
    return server


def is_virtuoso(store: RemoteStore) -> bool:
    """Whether the server is Virtuoso, by the name of its endpoint."""
    return store.address.endswith("/sparql")


def graphs(store: RemoteStore) -> list[NamedNode]:
    """Return the graphs of a server."""
    return store.read().graphs()


def put(store: RemoteStore, text: str, graph: NamedNode = SOURCE) -> None:
    """Assert triples."""
    append(store, graph, serialize(triples(text), format=RdfFormat.N_TRIPLES) or b"")


def infer(
    store: RemoteStore, rules: Sequence[Rule], data: Sequence[Triple] = (), limits: Limits | None = None
) -> RemoteReport:
    """Run rules over all graphs."""
    return run(store, rule_set(rules, data), inferred_graph=INFERRED, limits=limits)


def inferred(store: RemoteStore) -> str:
    """Return the inferred triples in the notation of these tests, sorted; blank nodes all alike."""
    lines = []
    for row in store.read().rows(f"SELECT ?s ?p ?o WHERE {{ GRAPH {INFERRED} {{ ?s ?p ?o }} }}"):
        words = (row[name] for name in "spo")
        lines.append(" ".join(word.value.replace("urn:x:", ":") if hasattr(word, "value") else "?" for word in words))
    return "\n".join(sorted(lines))


PARENTS = ":a :parent :b\n:b :parent :c\n:c :parent :d\n:d :parent :a"
ANCESTORS = [
    rule("?x :ancestor ?y", "?x :parent ?y", name="family/direct"),
    rule("?x :ancestor ?z", "?x :parent ?y . ?y :ancestor ?z", name="family/further"),
]


def test_recursion_ends_on_a_cycle(store: RemoteStore) -> None:
    """All nodes on a cycle are ancestors of each other, and no temporary graph remains."""
    put(store, PARENTS)
    report = infer(store, ANCESTORS)
    assert report.inferred == 16
    assert [(stratum.rounds, stratum.derived) for stratum in report.strata] == [(1, 4), (4, 12)]
    assert graphs(store) == [INFERRED, SOURCE]


def test_two_atoms_of_one_rule_meet_in_the_delta(store: RemoteStore) -> None:
    """If both atoms are recursive, each is read from the delta in turn."""
    put(store, "\n".join(f":n{i} :next :n{i + 1}" for i in range(9)))
    report = infer(store, [rule("?x :next ?z", "?x :next ?y . ?y :next ?z")])
    assert report.inferred == 36
    assert report.strata[0].rounds == 5


def test_what_is_asserted_is_not_inferred_again(store: RemoteStore) -> None:
    """A triple asserted in any graph is not in the inferred graph; running again changes nothing."""
    put(store, ":a :parent :b\n:a :ancestor :b")
    put(store, ":b :parent :c", NamedNode(f"{BASE}source/b"))
    for _ in range(2):
        infer(store, ANCESTORS)
        assert inferred(store) == ":a :ancestor :c\n:b :ancestor :c"


def test_graphs_are_chosen(store: RemoteStore) -> None:
    """The record of builds is excluded, the default graph is included, and graphs can be named."""
    if is_virtuoso(store):
        pytest.skip("it has no default graph of its own")
    put(store, ":a :parent :b", NamedNode(f"{BASE}builds"))
    put(store, ":b :parent :c")
    store.update("INSERT DATA { <urn:x:c> <urn:x:parent> <urn:x:d> }")
    infer(store, ANCESTORS)
    assert inferred(store) == ":b :ancestor :c\n:b :ancestor :d\n:c :ancestor :d"
    for chosen, expected in ((SOURCE, ":b :ancestor :c"), (DefaultGraph(), ":c :ancestor :d")):
        run(store, rule_set(ANCESTORS), inferred_graph=INFERRED, asserted_graphs=[chosen])
        assert inferred(store) == expected


def test_negation_sees_what_is_finished(store: RemoteStore) -> None:
    """NOT over an inferred predicate, with a filter inside."""
    put(store, PARENTS.replace(":d :parent :a", ":d :likes :d"))
    other = Exists((atom("?x :ancestor ?y"), keep("?y != <urn:x:b>")), negated=True)
    infer(store, [*ANCESTORS, rule("?x :root :yes", "?z :parent ?x", other)])
    assert inferred(store).splitlines()[-1] == ":d :root :yes"
    assert inferred(store).count(":root") == 1


def test_aggregates_count_each_triple_once(store: RemoteStore) -> None:
    """A triple asserted in two graphs counts once; without keys an empty group exists."""
    put(store, ":a :p :b\n:a :p :c")
    put(store, ":a :p :c", NamedNode(f"{BASE}source/b"))
    count = Column(Variable("n"), "COUNT", None)
    by_key = Aggregate((Variable("x"),), (count,), (atom("?x :p ?y"),))
    empty = Aggregate((), (count,), (atom("?x :none ?y"),))
    infer(store, [rule("?x :count ?n", by_key), rule(":all :count ?n", empty)])
    assert inferred(store) == ":a :count 2\n:all :count 0"


def test_assignments_and_values(store: RemoteStore) -> None:
    """An assignment gives a new term; rows of values join."""
    put(store, ":a :age 1\n:b :age 2\n:c :age 3")
    rows = Values((Variable("x"),), ((NamedNode("urn:x:a"),), (NamedNode("urn:x:b"),)))
    plus = Assignment(Variable("m"), expression("?n + 1", mints=True))
    infer(store, [rule("?x :next ?m", "?x :age ?n", rows, plus)])
    assert inferred(store) == ":a :next 2\n:b :next 3"


def test_asserted_only_atoms(store: RemoteStore) -> None:
    """`WHERE DATA` ignores derived triples, for any number of graphs."""
    put(store, ":a :parent :b\n:b :ancestor :z")
    rules = [*ANCESTORS, rule("?x :stated ?y", atom("?x :ancestor ?y", asserted=True))]
    infer(store, rules)
    assert [line for line in inferred(store).splitlines() if "stated" in line] == [":b :stated :z"]


def test_a_blank_node_for_each_solution(store: RemoteStore) -> None:
    """Each solution of the body gives one, with all its triples of the head."""
    put(store, ":a :p :b\n:a :p :c")
    infer(store, [rule("?x :has _:n . _:n :of ?x", "?x :p ?y")])
    minted = "GRAPH ?g { ?x <urn:x:has> ?n . ?n <urn:x:of> ?x FILTER(isBlank(?n)) }"
    (row,) = store.read().rows(f"SELECT (COUNT(DISTINCT ?n) AS ?count) {{ {minted} }}")
    assert row["count"].value == "2"


def test_auxiliary_triples_stay_inside(store: RemoteStore) -> None:
    """Predicates from decomposition join, recur, match no variable predicate, and are not in the result."""
    put(store, PARENTS)
    helper = f"={AUXILIARY}path"
    rules = [
        rule(f"?x {helper} ?y", "?x :parent ?y", part=1),
        rule(f"?x {helper} ?z", f"?x {helper} ?y . ?y :parent ?z", part=2),
        rule("?x :reaches ?y", f"?x {helper} ?y", part=3),
        rule("?p :used :yes", "?x ?p ?y", part=4),
    ]
    report = infer(store, rules)
    assert report.inferred == 19
    assert [line for line in inferred(store).splitlines() if ":used" in line] == [
        ":parent :used :yes",
        ":reaches :used :yes",
        ":used :used :yes",
    ]


def test_blocks_of_sparql_run_inside_strata(store: RemoteStore) -> None:
    """A block fed by its own stratum is applied to all data in each round."""
    put(store, PARENTS)
    block = EngineBlock(
        "?x <urn:x:ancestor>/<urn:x:parent> ?y",
        (Variable("x"), Variable("y")),
        reads=frozenset({NamedNode("urn:x:ancestor"), NamedNode("urn:x:parent")}),
        monotone=True,
    )
    assert infer(store, [ANCESTORS[0], rule("?x :ancestor ?y", block)]).inferred == 16


def test_exists_in_recursion(store: RemoteStore) -> None:
    """An atom inside EXISTS is read from the delta, too."""
    put(store, ":a :next :b\n:b :next :c\n:c :next :d\n:a :good :yes")
    good = Exists((atom("?x :good ?v"),))
    infer(store, [rule("?y :good :yes", "?x :next ?y", good)])
    assert inferred(store) == ":b :good :yes\n:c :good :yes\n:d :good :yes"


def test_rule_files_state_triples(store: RemoteStore) -> None:
    """Triples stated by a file count as asserted and are in the inferred graph, unless asserted elsewhere."""
    put(store, ":a :parent :b")
    report = infer(store, ANCESTORS, triples(":a :parent :b\n:b :parent :c"))
    assert report.inferred == 4
    assert inferred(store).splitlines()[-1] == ":b :parent :c"


def test_limits_leave_the_graph_as_it_was(store: RemoteStore) -> None:
    """Too many triples, or a deadline: KG205, the old triples remain and no temporary ones."""
    put(store, ":a :n 1\n:old :is :here", SOURCE)
    put(store, ":old :was :inferred", INFERRED)
    count = rule("?x :n ?m", "?x :n ?n", Assignment(Variable("m"), expression("?n + 1", mints=True)))
    with pytest.raises(RuleError, match="KG204"):
        infer(store, [count])
    for limits in (Limits(max_triples=5), Limits(deadline=0.2)):
        with pytest.raises(RuleError, match="KG205"):
            infer(store, [count], limits=limits)
        assert inferred(store) == ":old :was :inferred"
        assert graphs(store) == [INFERRED, SOURCE]


@contextmanager
def late(address: str, seconds: float) -> Iterator[str]:
    """Yield an address that forwards to a server, inserts with a delay; at the end all requests were forwarded."""

    class Late(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["Content-Length"]))
            if self.path == "/update" and b"INSERT" in body:
                time.sleep(seconds)
            kind, accept = self.headers["Content-Type"], self.headers["Accept"] or "*/*"
            headers = {"Content-Type": kind, "Accept": accept}
            request = urllib.request.Request(address + self.path, body, headers)  # noqa: S310 - a server of the test
            with urllib.request.urlopen(request) as answer, suppress(ConnectionError):  # noqa: S310 - the same
                self.send_response(answer.status)
                self.send_header("Content-Type", answer.headers["Content-Type"] or "text/plain")
                self.end_headers()
                self.wfile.write(answer.read())

        def log_message(self, *_: object) -> None:
            """Print nothing."""

    class Joining(ThreadingHTTPServer):
        daemon_threads = False

    with Joining(("127.0.0.1", 0), Late) as server:
        thread = Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}"
        finally:
            server.shutdown()
            thread.join()


def test_what_the_server_is_at_does_not_come_after_the_clean_up(store: RemoteStore, address: str) -> None:
    """An update running at the deadline is awaited, so no temporary graph appears after the run."""
    put(store, ":a :n 1")
    count = rule("?x :n ?m", "?x :n ?n", Assignment(Variable("m"), expression("?n + 1", mints=True)))
    with late(address, 0.4) as found, pytest.raises(RuleError, match="KG205"):
        infer(RemoteStore(f"{found}/query", f"{found}/update"), [count], limits=Limits(deadline=0.2))
    assert graphs(store) == [SOURCE]


def test_a_failure_of_the_server_is_told(store: RemoteStore) -> None:
    """A block rejected by the server is reported with its message, and no temporary graph remains."""
    put(store, ":a :parent :b")
    block = EngineBlock("nonsense", (Variable("x"),), reads=frozenset(), monotone=True)
    with pytest.raises(StoreError, match=r"KG225.*400"):
        infer(store, [rule("?x :is :bad", block)])
    assert graphs(store) == [SOURCE]
