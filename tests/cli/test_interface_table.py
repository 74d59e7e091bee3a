from __future__ import annotations

import io

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from kg.cli.commands.node import Row, interface_table
from kg.cli.links import Links
from kg.facts import Location

FOLDER = "ws/src/rover/rover_base/src"
ROWS = [
    Row("cmd_vel", "geometry_msgs/Twist", "parameter input_topic", Location(f"{FOLDER}/driver.cpp", 21), False),
    Row("~/status", "std_msgs/String", "", Location(f"{FOLDER}/../include/status.hpp", 8), True),
]


def drawn(rows: list[Row], columns: int) -> str:
    """Return the table as shown by a terminal of so many columns."""
    console = Console(file=io.StringIO(), width=columns, color_system=None)
    with console.capture() as captured:
        console.print(interface_table([("publishes", rows)], "local/ws", Links.of([]), columns))
    return captured.get()


def test_wide_terminals_show_whole_paths() -> None:
    """A wide terminal shows whole paths."""
    assert f"{FOLDER}/driver.cpp:21" in drawn(ROWS, 130)


def test_narrower_ones_leave_out_the_folders_that_all_share() -> None:
    """A narrower terminal omits the common folders; the distinguishing parts remain."""
    shown = drawn(ROWS, 105)
    assert " …/driver.cpp:21" in shown
    assert FOLDER not in shown


@pytest.mark.parametrize("columns", [64, 80])
def test_narrow_ones_show_the_file_and_its_line(columns: int) -> None:
    """Names, types, files and lines are shown in full; remarks may move to the next line."""
    shown = drawn(ROWS, columns)
    assert all(part in shown for part in ("cmd_vel", "geometry_msgs/Twist", " driver.cpp:21", "parameter"))


@pytest.mark.parametrize("columns", range(94, 130))
def test_long_remarks_are_folded_rather_than_names_and_places(columns: int) -> None:
    """Where a remark is too long for its column, every name, type and place is still whole."""
    rows = [
        Row(
            "/base_node/odometry_frame_name", "base_msgs/SensorStateArray", "none", Location("base_node.hpp", 96), False
        ),
        Row("/base_node/{}", "(not known)", "its parameter file is unknown", Location("base.launch.py", 120), False),
    ]
    shown = drawn(rows, columns)
    assert all(part in shown for row in rows for part in (row.name, row.type, f" {row.location}"))


@given(
    st.lists(
        st.builds(
            Row,
            st.text("abc/~", min_size=1, max_size=40),
            st.text("abc/", min_size=1, max_size=40),
            st.text("abc ", max_size=40),
            st.builds(Location, st.text("abc/.", min_size=1, max_size=60), st.integers(1, 9999)),
            st.booleans(),
        ),
        min_size=1,
        max_size=5,
    ),
    st.integers(50, 200),
)
def test_no_line_is_wider_than_the_terminal_and_nothing_is_lost(rows: list[Row], columns: int) -> None:
    """Whatever the names, lines fit the width, and no letter of a name is lost."""
    shown = drawn(rows, columns)
    assert all(len(line) <= columns for line in shown.splitlines())
    assert sum(map(str.isalpha, shown)) >= sum(sum(map(str.isalpha, row.name + row.type + row.remark)) for row in rows)
