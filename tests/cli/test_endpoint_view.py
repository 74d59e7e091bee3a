"""Rows of `kg topic` and `kg param` for nodes that many launch files start."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import pytest
from rich.console import Console

from kg.cli.commands.channels import endpoint_view, parameter_view
from kg.cli.links import Links

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


def at(path: str, line: int) -> dict[str, Any]:
    """Return the evidence for a line."""
    return {"path": path, "line": line, "repository": "local/ws", "vscode": ""}


def started(number: int) -> list[Mapping[str, Any]]:
    """Return the value of one parameter in a number of launch files, which load the same parameter file."""
    return [
        {
            "instance": "/driver",
            "parameter": "/driver/rate",
            "value": "10",
            "reason": None,
            "set_at": at("config/driver.yaml", 3),
            "launched": at(f"launch/{one}.launch", 5),
            "systems": [f"base/launch/{one}.launch"],
        }
        for one in range(number)
    ]


def end(name: str, **given: Any) -> dict[str, Any]:
    """Return an endpoint of `/scan`, a subscriber in one launch file."""
    return {
        "title": "subscribes",
        "role": "subscribes",
        "instance": name,
        "package": "base",
        "node": "driver",
        "plugins": [],
        "types": ["sensor_msgs/LaserScan"],
        "quality": "",
        "qos": None,
        "switches": [],
        "doubt": None,
        "evidence": at("src/driver.cpp", 12),
        "launched": at("launch/base.launch", 5),
        "calls": [],
        "systems": ["base/launch/base.launch"],
        **given,
    }


def topic(*ends: Mapping[str, Any], columns: int = 200) -> list[str]:
    """Return the lines of `kg topic` for these ends on a terminal of this width."""
    console = Console(file=io.StringIO(), width=columns, color_system=None)
    types = sorted({kind for one in ends for kind in one["types"]})
    found = {"name": "/scan", "kind": "topic", "types": types, "endpoints": ends}
    found |= {"systems": ["base/launch/base.launch"], "definitions": [], "findings": []}
    with console.capture() as captured:
        console.print(*endpoint_view(found, Links.of([]), columns, every=False, via=False))
    return captured.get().splitlines()


def shown(values: Sequence[Mapping[str, Any]], *, every: bool = False) -> list[str]:
    """Return the lines of `kg param` on a wide terminal."""
    console = Console(file=io.StringIO(), width=200, color_system=None)
    found = {"name": "rate", "declared": [], "values": values}
    with console.capture() as captured:
        console.print(*parameter_view(found, Links.of([]), 200, every=every, via=False))
    return captured.get().splitlines()


@pytest.mark.parametrize("number", [1, 3])
def test_a_few_starts_have_a_row_each(number: int) -> None:
    """Up to three starts with the same value are shown with their launch lines."""
    lines = shown(started(number))
    assert [line.split()[-2] for line in lines if "/driver" in line] == [
        f"launch/{one}.launch:5" for one in range(number)
    ]


def test_many_equal_starts_are_one_row() -> None:
    """More than three starts with the same value become one row, and a line names the option for all."""
    (row,) = [line for line in shown(started(4)) if "/driver" in line]
    assert row.split() == ["/driver", "10", "config/driver.yaml:3", "4", "launch", "lines", "4", "launch", "files"]
    assert shown(started(4))[-1] == "--all shows every launch line"


def test_another_value_has_its_own_row() -> None:
    """A start with another value is not part of the row of the others."""
    other = {**started(1)[0], "value": "20"}
    assert len([line for line in shown([*started(5), other]) if "/driver" in line]) == 2


def test_all_shows_every_launch_line() -> None:
    """With --all each launch file has a row."""
    lines = shown(started(5), every=True)
    assert len([line for line in lines if "/driver" in line]) == 5
    assert "--all" not in "".join(lines)


def test_a_name_with_a_doubt_is_conditional() -> None:
    """An end that has another name in some case shows the case as a condition, whatever its words."""
    lines = topic(end("/driver", doubt="where `scan` is set", quality="where `scan` is set"))
    assert any("condition, QoS" in line for line in lines)


def test_types_take_the_place_of_qos() -> None:
    """Where the terminal is narrow, the types of a topic stay, and the quality of service is left out."""
    one = end("/front/driver", quality="best_effort, volatile, keep_last 10")
    other = end("/rear/driver", quality="reliable, volatile, keep_last 1", types=["sensor_msgs/PointCloud2"])
    words = "\n".join(topic(one, other, columns=80))
    assert "sensor_msgs/PointCloud2" in words
    assert "best_effort" not in words
    assert "best_effort" in "\n".join(topic(one, other))
