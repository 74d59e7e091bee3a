from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st
from pyoxigraph import NamedNode, RdfFormat
from robot.live.seen import ADDRESS, ROVER, graph_of, without

from kg.errors import StoreError
from kg.facts import Role
from kg.graph.iris import RUNNING, Iris
from kg.lint.reading import read_findings
from kg.pipeline.inferring import Inference
from kg.pipeline.launching import chosen
from kg.robot.capabilities import capabilities_of
from kg.robot.connection import ComputationGraph, LiveEnd, LiveNode
from kg.robot.live import infer
from kg.robot.live.keeping import Keeper
from kg.settings import load
from kg.store.embedded import EmbeddedStore
from kg.store.opening import existing
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from kg.settings import Settings

_NAME = "rover"


def _keeper(store: EmbeddedStore, settings: Settings) -> Keeper:
    return Keeper(store, settings, address=ADDRESS, name=_NAME)


def _inferred(store: EmbeddedStore, settings: Settings) -> set[str]:
    graph = NamedNode(Iris(settings.base).graph("inferred"))
    with store.read() as snapshot:
        return set(snapshot.dump(RdfFormat.N_TRIPLES, graph=graph).decode().splitlines())


def test_what_runs_is_in_the_store_with_what_follows(store: EmbeddedStore, settings: Settings) -> None:
    """The store has the same facts about a running system as inference in memory."""
    kept = _keeper(store, settings).keep(ROVER)
    with store.read() as snapshot:
        iri = Iris(settings.base).configuration(RUNNING, _NAME)
        found = capabilities_of(snapshot, iri, ADDRESS)
    assert found == infer(ROVER, settings, address=ADDRESS)
    assert set(kept.capabilities) == {one.iri for one in found.capabilities}


def test_nothing_is_written_where_nothing_changed(store: EmbeddedStore, settings: Settings) -> None:
    """The same graph again creates no generation, and the facts are the same."""
    keeper = _keeper(store, settings)
    first, second = keeper.keep(ROVER), keeper.keep(ROVER)
    assert (first.generation, second.generation) == (1, None)
    assert first.capabilities == second.capabilities


def test_nodes_that_go_take_their_capabilities_along(store: EmbeddedStore, settings: Settings) -> None:
    """Triples inferred from an ended node disappear, and return with it."""
    keeper = _keeper(store, settings)
    before = keeper.keep(ROVER).capabilities
    gone = before.keys() - keeper.keep(without(ROVER, "/base")).capabilities.keys()
    assert {iri.rpartition("#")[2] for iri in gone} >= {"drivingAtVelocity", "sensingPose"}
    assert keeper.keep(ROVER).capabilities == before


def test_a_store_that_another_process_wrote_is_read_again(store: EmbeddedStore, settings: Settings) -> None:
    """A graph dropped by another process is written again."""
    keeper = _keeper(store, settings)
    keeper.keep(ROVER)
    with store.write("test") as transaction:
        transaction.drop_graph(keeper.graph)
    keeper.keep(without(ROVER, "/drone"))
    with store.read() as snapshot:
        assert snapshot.query("ASK { ?s a rnkg:RunningSystem }", prefixes=PREFIXES)


def test_the_end_is_marked(store: EmbeddedStore, settings: Settings) -> None:
    """When watching ends the graph remains, with the time."""
    keeper = _keeper(store, settings)
    keeper.keep(ROVER)
    keeper.keep(ROVER, until="2026-05-01T12:00:00Z")
    with store.read() as snapshot:
        rows: Any = snapshot.query("SELECT ?t { ?s a rnkg:RunningSystem ; rnkg:seenUntil ?t }", prefixes=PREFIXES)
        assert [row["t"].value for row in rows] == ["2026-05-01T12:00:00Z"]


def test_a_change_that_could_not_be_written_is_written_later(
    store: EmbeddedStore, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After a failed transaction, the keeper writes the change again."""
    keeper = _keeper(store, settings)
    keeper.keep(ROVER)
    less = without(ROVER, "/drone")
    with monkeypatch.context() as patched:
        patched.setattr(Inference, "run", _full)
        with pytest.raises(StoreError):
            keeper.keep(less)
    kept = keeper.keep(less)
    assert kept.generation is not None
    with store.read() as snapshot:
        assert not snapshot.query('ASK { ?s rnkg:name "/drone" ; a rnkg:NodeInstance }', prefixes=PREFIXES)


def _full(*_: object) -> None:
    raise StoreError("KG304", "the disk is full")


_NODES = ("/a", "/b", "/c")
_WAYS = st.tuples(
    st.sampled_from([Role.PUBLISHES, Role.SUBSCRIBES]),
    st.sampled_from(["/cmd_vel", "/takeoff", "/scan"]),
    st.sampled_from(["geometry_msgs/Twist", "std_msgs/Empty", "sensor_msgs/LaserScan", None]),
)
_GRAPHS = st.dictionaries(st.sampled_from(_NODES), st.sets(_WAYS, max_size=3)).map(
    lambda nodes: ComputationGraph(
        1,
        tuple(LiveNode(name) for name in sorted(nodes)),
        tuple(LiveEnd(name, *way) for name in sorted(nodes) for way in sorted(nodes[name], key=repr)),
    )
)


@given(st.lists(_GRAPHS, min_size=2, max_size=4))
@examples(max_examples=4)
def test_any_sequence_of_changes_gives_what_the_last_graph_gives(graphs: list[ComputationGraph]) -> None:
    """The result maintained incrementally equals the one inferred from the last graph in a fresh store."""
    with tempfile.TemporaryDirectory() as folder:
        found = []
        for name, sequence in (("maintained", graphs), ("anew", graphs[-1:])):
            flags = {"store": str(Path(folder) / name), "rule_families": "capability,communication"}
            given_ = load(flags, environment={}, folder=Path(folder))
            store = EmbeddedStore.create(Path(folder) / name)
            keeper = _keeper(store, given_)
            for graph in sequence:
                keeper.keep(graph)
            found.append(_inferred(store, given_))
    assert found[0] == found[1]


def test_running_nodes_are_told_to_be_of_the_code_of_the_store(built: Settings) -> None:
    """Running nodes are matched with code by name and interface, which links evidence and findings to the code."""
    store = existing(built)
    (rover,) = chosen(built, store, "rover.launch", {}, {})
    keeper = _keeper(store, built)
    kept = keeper.keep(graph_of(rover))
    assert str(kept.matches["/rover1/base_controller"].type).endswith(":rover_robot/base_controller")
    with store.read() as snapshot:
        rows: Any = snapshot.query(
            "SELECT ?path { GRAPH ?g { ?s rnkg:hasInstance ?i } ?s a rnkg:RunningSystem . "
            "?i ros:hasComponent/rnkg:declaredBy/rnkg:path ?path }",
            prefixes=PREFIXES,
        )
        paths = {row["path"].value.rpartition("/")[2] for row in rows}
        findings = read_findings(snapshot, built.base, keeper.iri)
    assert {"base_controller.cpp", "patrol.py"} <= paths
    assert "KG404" in {one.code for one in findings}
