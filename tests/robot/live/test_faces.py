from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest
from cli.program import Program
from robot.live.seen import ADDRESS, graph_of

from kg.pipeline.launching import chosen
from kg.robot.live.keeping import Keeper
from kg.settings import load
from kg.store.opening import existing, reading
from kg.views.system import system
from kg.views.systems import systems

if TYPE_CHECKING:
    from pathlib import Path

    from kg.settings import Settings


@pytest.fixture(scope="module")
def kept(workspace: Path, tmp_path_factory: pytest.TempPathFactory) -> Settings:
    """The settings of a store of the example workspace, with an observation of the running rover."""
    import shutil  # noqa: PLC0415 - of this fixture alone

    root = tmp_path_factory.mktemp("kept")
    shutil.copytree(workspace / ".kg", root / ".kg")
    settings = load({"store": str(root / ".kg")}, environment={}, folder=root)
    store = existing(settings)
    (rover,) = chosen(settings, store, "rover.launch", {}, {})
    Keeper(store, settings, address=ADDRESS, name="rover").keep(graph_of(rover))
    return settings


@pytest.fixture
def kg(kept: Settings, tmp_path: Path) -> Program:
    """The program on that store."""
    (tmp_path / "kg.toml").write_text(f'store = "{kept.store}"\n')
    return Program(tmp_path)


def test_instances_are_listed(kg: Program) -> None:
    """`kg instances` has the running nodes with their code, and the place of observation."""
    run = kg("instances", "robot/rover", "--json")
    found = {one["name"]: one for one in map(json.loads, run.out.splitlines())}
    base = found["/rover1/base_controller"]
    assert (base["package"], base["node"]) == ("rover_robot", "base_controller")
    assert "base_controller at http://127.0.0.1:" in json.dumps(base)


def test_the_graph_is_drawn(kg: Program) -> None:
    """`kg graph` draws the communication of the nodes."""
    run = kg("graph", "robot/rover")
    assert run.code == 0, run.err
    assert "/rover1/scan_filtered" in run.out


def test_lint_says_what_is_wrong(kg: Program) -> None:
    """`kg lint` has the same findings in the running system as in a launch file, down to the line of code."""
    run = kg("lint", "--launch", "robot/rover")
    assert "KG404" in run.out + run.err
    assert "base_controller.cpp:" in run.out


def test_why_ends_in_code_and_in_the_peer(kg: Program) -> None:
    """The proof of a live capability ends in the line of code, and in the peer that reported the node, with time."""
    run = kg("why", "/rover1/scan_filter", "rnkg:hasCapability", "capability:laserScanning")
    assert "scan_filter_nodelet.cpp:30" in run.out


def test_pages_show_it_as_a_system(kept: Settings) -> None:
    """The views of systems and of one system include it, with its nodes and the picture."""
    with reading(kept) as snapshot:
        (row,) = [one for one in systems(snapshot, kept)["systems"] if one["name"] == "robot/rover"]
        found = system(snapshot, kept, name="robot/rover")
    assert (row["repository"], row["nodes"]) == ("robot", len(found["instances"]))
    assert found["dialect"] == "running"
    assert found["picture"]
    assert found["counts"]["topics"] > 5
