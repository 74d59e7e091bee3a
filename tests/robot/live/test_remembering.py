"""The cache of capabilities between commands."""

from __future__ import annotations

import os
from dataclasses import replace
from threading import Thread
from typing import TYPE_CHECKING

import msgspec
import pytest

from kg.facts import Role
from kg.robot.capability import Capabilities
from kg.robot.connection import ComputationGraph, LiveEnd, LiveNode
from kg.robot.live import infer, inference
from kg.robot.live.inference import MOST, cache_folder, cache_key, remembered
from kg.settings import Settings, load

if TYPE_CHECKING:
    from pathlib import Path

GRAPH = ComputationGraph(
    1,
    (LiveNode("/laser", "http://here:1"),),
    (LiveEnd("/laser", Role.PUBLISHES, "/scan", "sensor_msgs/LaserScan"),),
)


@pytest.fixture(autouse=True)
def _cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    """Settings with a folder of user rules."""
    (tmp_path / "rules").mkdir()
    return load({"rules": str(tmp_path / "rules")}, environment={})


def test_the_second_time_no_rule_runs(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same robot has the same capabilities without inference, although its nodes have other addresses."""
    first = infer(GRAPH, settings, address="ros1://here:11311")
    monkeypatch.setattr(inference, "infer_system", None)
    again = replace(GRAPH, nodes=(LiveNode("/laser", "http://here:2"),))
    assert infer(again, settings, address="ros1://here:11311") == first
    assert [one.name for one in first.capabilities if one.ways] == ["laserScanning"]


def test_another_graph_rule_or_name_is_inferred(settings: Settings, tmp_path: Path) -> None:
    """The key covers all input of the capabilities."""
    before = cache_key(GRAPH, settings, ("a",))
    assert cache_key(replace(GRAPH, ends=()), settings, ("a",)) != before
    assert cache_key(GRAPH, settings, ("b",)) != before
    (tmp_path / "rules" / "own.rq").write_text("# rule: own", encoding="utf-8")
    assert cache_key(GRAPH, settings, ("a",)) != before


def test_a_broken_file_is_made_again() -> None:
    """A cache file without valid JSON counts as missing, and is replaced."""
    made = Capabilities(of="here")
    remembered("a", lambda: made)
    (cache_folder() / "a.json").write_bytes(b"{")
    assert remembered("a", lambda: made) == made
    assert remembered("a", lambda: Capabilities(of="never")) == made


def test_there_are_so_many_files_at_most() -> None:
    """The least recently used files are removed; one that is used remains."""
    for number in range(MOST):
        remembered(f"{number}", lambda: Capabilities(of="x"))
        os.utime(cache_folder() / f"{number}.json", (number, number))
    remembered("0", lambda: Capabilities(of="never"))
    remembered("new", lambda: Capabilities(of="x"))
    names = {path.stem for path in cache_folder().iterdir()}
    assert len(names) == MOST
    assert {"0", "new"} <= names
    assert "1" not in names


def test_several_at_once_leave_whole_files() -> None:
    """A concurrent reader gets a complete file or none, and no temporary file remains."""
    made = Capabilities(of="x" * 10_000)
    found: list[Capabilities] = []
    threads = [Thread(target=lambda: found.append(remembered("a", lambda: made))) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [made] * 8
    assert [path.name for path in cache_folder().iterdir()] == ["a.json"]


def test_without_a_folder_nothing_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a writable cache only time is lost."""
    (tmp_path / "file").write_text("", encoding="utf-8")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert remembered("a", lambda: Capabilities(of="here")).of == "here"


def test_what_is_kept_looks_the_same(settings: Settings) -> None:
    """Cached capabilities are shown like inferred ones, also as JSON."""
    first = infer(GRAPH, settings, address="ros1://here:11311")
    again = infer(GRAPH, settings, address="ros1://here:11311")
    assert msgspec.json.encode(again) == msgspec.json.encode(first)
