from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest
from cli.rover import DRIVER, PLANNER, build, package
from graph.samples import source_triples
from pyoxigraph import RdfFormat, Store

from kg.errors import UnknownNameError, UsageError
from kg.facts import Location, Repository
from kg.graph.iris import Iris
from kg.store.embedded import EmbeddedStore
from kg.views.names import one_node, require_package

if TYPE_CHECKING:
    from pathlib import Path

    from kg.store.snapshot import EmbeddedSnapshot


@pytest.fixture
def rover(tmp_path: Path) -> EmbeddedSnapshot:
    """Return the store of the rover."""
    build(tmp_path / ".kg")
    return EmbeddedStore.find(tmp_path).read()


@pytest.mark.parametrize(
    "name",
    ["planner", "nav/planner", "local/ws:nav/planner", "rover_sim/driver", "github.com/acme/rover:rover_sim/driver"],
)
def test_a_node_is_found_by_as_much_of_its_name_as_tells_it(rover: EmbeddedSnapshot, name: str) -> None:
    """The name alone suffices if it is unique; package and source may precede it."""
    (found,) = one_node(rover, name)
    assert found.full_name.endswith(name)


@pytest.mark.parametrize("name", ["Planner", "nav/Planner"])
def test_a_node_is_found_by_the_class_that_is_loaded(rover: EmbeddedSnapshot, name: str) -> None:
    """A component is found by its class, as in `kg search`."""
    (found,) = one_node(rover, name)
    assert found.node.plugin == "nav/Planner"


def test_of_several_nodes_the_ways_to_name_each_are_said(rover: EmbeddedSnapshot) -> None:
    """The error lists the unambiguous names."""
    with pytest.raises(UsageError) as caught:
        one_node(rover, "driver")
    assert "`kg node rover_base/driver`" in (caught.value.hint or "")
    assert "`kg node rover_sim/driver`" in (caught.value.hint or "")


@pytest.mark.parametrize(
    ("name", "meant"), [("plannr", "`planner`"), ("nav/plannr", "`nav/planner`"), ("driv", "`driver`")]
)
def test_an_unknown_node_gets_the_nearest(rover: EmbeddedSnapshot, name: str, meant: str) -> None:
    """Suggestions have the same form as the misspelt name."""
    with pytest.raises(UnknownNameError) as caught:
        one_node(rover, name)
    assert meant in (caught.value.hint or "")


def test_an_unknown_package_gets_the_nearest(rover: EmbeddedSnapshot) -> None:
    """Known packages pass, with or without their source; a misspelt one gets a suggestion."""
    require_package(rover, "nav")
    require_package(rover, "local/ws:nav")
    with pytest.raises(UnknownNameError, match="unknown package `navi`"):
        require_package(rover, "navi")


def test_a_node_that_its_package_declares_twice_is_shown_twice() -> None:
    """No name distinguishes them, so both are returned."""
    twice = package("nav", "local/ws", PLANNER, replace(PLANNER, location=Location("src/other.cpp", 3)), DRIVER)
    store = Store()
    store.load(source_triples(Repository("local/ws", "/ws"), [twice], Iris()), format=RdfFormat.N_TRIPLES)
    found = one_node(store, "planner")
    assert [len(one.node.interfaces) for one in found] == [1, 1]
    assert [str(one.node.location) for one in found] == ["src/other.cpp:3", "src/planner.cpp:5"]
