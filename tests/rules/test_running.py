from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pyoxigraph import BlankNode, NamedNode, RdfFormat, parse

from kg.errors import Place, RuleError
from kg.rules.columns import lines
from kg.rules.engine.evaluate import Limits
from kg.rules.files import Documentation, RuleFile, RuleSet
from kg.rules.form import Atom, Exists, Rule, Variable
from kg.rules.recording import Names
from kg.rules.running import Runner
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from kg.rules.form import Element
    from kg.rules.reports import RunReport

NAMES = Names.of("http://example.org/", "http://example.org/ns#")
A, B = NamedNode("http://example.org/graph/a"), NamedNode("http://example.org/graph/b")
X, Y, Z, N = Variable("x"), Variable("y"), Variable("z"), Variable("n")
PARENT, ANCESTOR, CHILDLESS, KNOWS = (NamedNode(f"urn:{name}") for name in ("parent", "ancestor", "childless", "knows"))
TYPE = NamedNode("http://www.w3.org/1999/02/22-rdf-syntax-ns#type")


def rule_set(*rules: tuple[str, Atom, tuple[Element, ...]], data: str = "") -> RuleSet:
    """Return rules given as name, head and body, of one file that states `data`."""
    made = tuple(Rule(name, (head,), body, Place("test.rq", 1)) for name, head, body in rules)
    triples = tuple(quad.triple for quad in parse(data, RdfFormat.N_TRIPLES))
    return RuleSet((RuleFile("family/test", Path("test.rq"), "", Documentation(), made, triples),))


FAMILY = rule_set(
    ("family/base", Atom(X, ANCESTOR, Y), (Atom(X, PARENT, Y),)),
    ("family/step", Atom(X, ANCESTOR, Z), (Atom(X, PARENT, Y), Atom(Y, ANCESTOR, Z))),
    ("family/leaf", Atom(Y, TYPE, CHILDLESS), (Atom(X, PARENT, Y), Exists((Atom(Y, PARENT, Z),), negated=True))),
)


def parents(*pairs: tuple[int, int]) -> bytes:
    """Return triples of parents and their children."""
    return "".join(f"<urn:{one}> <urn:parent> <urn:{other}> .\n" for one, other in pairs).encode()


@pytest.fixture
def store(tmp_path: Path) -> EmbeddedStore:
    """Return a store with two graphs that share a triple."""
    made = EmbeddedStore.create(tmp_path / ".kg")
    with made.write("test") as transaction:
        transaction.replace_graphs({A: [parents((1, 2), (2, 3))], B: [parents((2, 3), (3, 4))]})
    return made


def inferred(store: EmbeddedStore) -> list[bytes]:
    """Return the lines of the graph of inferred triples."""
    with store.read() as snapshot:
        return sorted(snapshot.dump(RdfFormat.N_TRIPLES, graph=NAMES.inferred).splitlines())


def figures(report: RunReport) -> tuple[str, int, int, int]:
    """Return the result of a run: mode, inferred triples, those added and removed."""
    return report.mode, report.inferred, report.added, report.removed


def test_a_run_writes_what_follows_from_all_graphs_and_the_next_one_changes_nothing(store: EmbeddedStore) -> None:
    """The union of the graphs is read, each triple once; without a change no generation is created."""
    report = Runner(NAMES, store.layout.cache).run(store, FAMILY)
    assert figures(report) == ("full", 7, 7, 0)
    assert report.asserted == 3
    assert report.strata == 1
    assert b"<urn:1> <urn:ancestor> <urn:4> ." in inferred(store)
    again = Runner(NAMES, store.layout.cache).run(store, FAMILY)
    assert figures(again) == ("incremental", 7, 0, 0)
    assert again.generation is None
    anew = Runner(NAMES, store.layout.cache).run(store, FAMILY, incremental=False)
    assert figures(anew) == ("full", 7, 0, 0)
    assert store.layout.current() == report.generation


def test_a_change_of_one_graph_is_maintained_in_the_transaction_that_makes_it(store: EmbeddedStore) -> None:
    """A replaced graph is read again; its removed triples disappear with their inferences."""
    Runner(NAMES, store.layout.cache).run(store, FAMILY)
    runner = Runner(NAMES, store.layout.cache)
    with store.write("test") as transaction:
        transaction.replace_graphs({B: [parents((2, 3), (3, 5), (8, 9))]})
        report = runner.run_within(transaction, FAMILY)
    runner.remember(store.layout.current())
    assert figures(report)[2:] == (6, 4)
    assert b"<urn:1> <urn:ancestor> <urn:5> ." in inferred(store)
    assert b"<urn:1> <urn:ancestor> <urn:4> ." not in inferred(store)
    assert figures(Runner(NAMES, store.layout.cache).run(store, FAMILY)) == ("incremental", 9, 0, 0)


def test_a_dry_run_tells_the_difference_and_writes_nothing(store: EmbeddedStore) -> None:
    """The report has the lines to add; the store has no new generation."""
    report = Runner(NAMES, store.layout.cache).run(store, FAMILY, dry_run=True)
    assert report.dry_run
    added = b"".join(lines(report.change.added, report.change.dictionary)).splitlines()
    assert b"<urn:1> <urn:ancestor> <urn:2> ." in added
    assert not len(report.change.removed)
    assert store.layout.current() == 1


def test_a_limit_leaves_the_store_as_it_is(store: EmbeddedStore) -> None:
    """KG205 ends a run before anything is written."""
    with pytest.raises(RuleError) as caught:
        Runner(NAMES, store.layout.cache).run(store, FAMILY, limits=Limits(max_triples=2))
    assert caught.value.code == "KG205"
    assert store.layout.current() == 1
    assert store.layout.numbers() == [1]


def test_changes_of_any_kind_are_noticed(store: EmbeddedStore) -> None:
    """SPARQL updates, patches, dropped graphs, and a dropped graph of inferred triples."""
    Runner(NAMES, store.layout.cache).run(store, FAMILY)
    with store.write("test") as transaction:
        transaction.update(f"DELETE DATA {{ GRAPH {A} {{ <urn:1> <urn:parent> <urn:2> }} }}")
    assert figures(Runner(NAMES, store.layout.cache).run(store, FAMILY))[1:] == (4, 0, 3)
    with store.write("test") as transaction:
        transaction.append(A, parents((0, 2)))
    assert figures(Runner(NAMES, store.layout.cache).run(store, FAMILY))[1:] == (7, 3, 0)
    with store.write("test") as transaction:
        transaction.drop_graph(NAMES.inferred)
    assert figures(Runner(NAMES, store.layout.cache).run(store, FAMILY))[1:] == (7, 7, 0)
    with store.write("test") as transaction:
        transaction.drop_graph(B)
    assert figures(Runner(NAMES, store.layout.cache).run(store, FAMILY))[1:] == (4, 1, 4)


def test_a_damaged_cache_is_not_used(store: EmbeddedStore) -> None:
    """A file with a wrong digest counts as missing."""
    Runner(NAMES, store.layout.cache).run(store, FAMILY)
    for path in (store.layout.cache / "columns").iterdir():
        content = path.read_bytes()
        path.write_bytes(content[:-1] + bytes([content[-1] ^ 1]))
    assert figures(Runner(NAMES, store.layout.cache).run(store, FAMILY)) == ("full", 7, 0, 0)


def test_small_changes_are_done_again_by_later_processes_until_there_are_many(store: EmbeddedStore) -> None:
    """The saved result is not rewritten for each change; the inferences are right in any case."""
    with store.write("test") as transaction:
        transaction.patch_graph(B, b"", parents(*((number, number + 1) for number in range(100, 300, 2))))
    Runner(NAMES, store.layout.cache).run(store, FAMILY)
    left = {change: _changed_by_another_process(store, change) for change in range(5, 25)}
    assert left[5] == left[6] == left[7] != left[24]
    kept = inferred(store)
    with store.write("test") as transaction:
        transaction.drop_graph(NAMES.inferred)
    Runner(NAMES, store.layout.cache).run(store, FAMILY)
    assert inferred(store) == kept


def _changed_by_another_process(store: EmbeddedStore, number: int) -> str:
    """Add a child with its inferences, and return the name of the file that the next process loads."""
    runner = Runner(NAMES, store.layout.cache)
    with store.write("test") as transaction:
        transaction.patch_graph(A, b"", parents((number - 1, number)))
        assert runner.run_within(transaction, FAMILY).mode == "incremental"
    runner.remember(store.layout.current())
    (path,) = (store.layout.cache / "columns").iterdir()
    return path.name


def test_blank_nodes_of_heads_keep_their_labels(store: EmbeddedStore) -> None:
    """A rule that creates blank nodes gives the same labels in every run and in the store."""
    rules = rule_set(("family/knows", Atom(X, KNOWS, BlankNode("one")), (Atom(X, PARENT, Y),)))
    assert figures(Runner(NAMES, store.layout.cache).run(store, rules)) == ("full", 3, 3, 0)
    first = inferred(store)
    assert figures(Runner(NAMES, store.layout.cache).run(store, rules, incremental=False)) == ("full", 3, 0, 0)
    with store.write("test") as transaction:
        transaction.patch_graph(A, parents((1, 2)), b"")
    assert figures(Runner(NAMES, store.layout.cache).run(store, rules)) == ("full", 2, 0, 1)
    assert set(inferred(store)) < set(first)


def test_what_rule_files_state_is_inferred_unless_a_graph_states_it(store: EmbeddedStore) -> None:
    """Triples of DATA count as asserted ones and are in the graph of inferred ones."""
    rules = rule_set(
        ("family/base", Atom(X, ANCESTOR, Y), (Atom(X, PARENT, Y),)), data=parents((1, 2), (7, 8)).decode()
    )
    assert figures(Runner(NAMES, store.layout.cache).run(store, rules)) == ("full", 5, 5, 0)
    assert b"<urn:7> <urn:parent> <urn:8> ." in inferred(store)
    assert b"<urn:1> <urn:parent> <urn:2> ." not in inferred(store)


def test_the_graph_of_builds_has_one_activity_a_run_with_its_rules(store: EmbeddedStore) -> None:
    """Rules with inferences are listed with their first derivations; a run without changes is not recorded."""
    Runner(NAMES, store.layout.cache).run(store, FAMILY)
    Runner(NAMES, store.layout.cache).run(store, FAMILY, incremental=False)
    with store.read() as snapshot:
        text = snapshot.dump(RdfFormat.N_TRIPLES, graph=NAMES.builds).decode()
    assert text.count("http://www.w3.org/ns/prov#Activity>") == 1
    assert text.count("<http://www.w3.org/ns/shacl#sourceRule>") == 3
    assert "<http://www.w3.org/ns/shacl#sourceRule> <http://example.org/rule/family/base>" in text


edges = st.tuples(st.integers(0, 4), st.integers(0, 4))
changes = st.lists(
    st.tuples(st.sampled_from([A, B]), st.lists(edges, max_size=3), st.lists(edges, max_size=3), st.booleans()),
    min_size=1,
    max_size=4,
)


@settings(max_examples=6, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(changes)
def test_any_sequence_of_changes_gives_what_starting_over_gives(
    tmp_path_factory: pytest.TempPathFactory,
    made: list[tuple[NamedNode, list[tuple[int, int]], list[tuple[int, int]], bool]],
) -> None:
    """Patches, in one process or one for each, give the triples of a run from scratch."""
    store = EmbeddedStore.create(tmp_path_factory.mktemp("changes") / ".kg")
    with store.write("test") as transaction:
        transaction.replace_graphs({A: [parents((1, 2), (2, 3))], B: [parents((2, 3), (3, 4))]})
    runner = Runner(NAMES, store.layout.cache)
    runner.run(store, FAMILY)
    for graph, gone, come, stays in made:
        with store.write("test") as transaction:
            transaction.patch_graph(graph, parents(*gone), parents(*come))
            runner = runner if stays else Runner(NAMES, store.layout.cache)
            runner.run_within(transaction, FAMILY)
        runner.remember(store.layout.current())
    kept = inferred(store)
    with store.write("test") as transaction:
        transaction.drop_graph(NAMES.inferred)
    Runner(NAMES).run(store, FAMILY)
    assert inferred(store) == kept
