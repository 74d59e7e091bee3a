from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from kg.errors import UnknownNameError, UsageError
from kg.graph.reading.systems import SystemName
from kg.pipeline.launch_names import assignments, check_given, find, matching

if TYPE_CHECKING:
    from pathlib import Path

BASE = SystemName("base", "bringup/launch/base.launch", "bringup/launch/base.launch", 1)
OTHER = SystemName("base", "tests/launch/base.launch", "tests/launch/base.launch", 1)
ARM = SystemName("arm", "src/arm/launch/left/arm.launch.py", "arm/launch/left/arm.launch.py", 2)
NAMES = [BASE, OTHER, ARM]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("bringup/launch/base.launch", [BASE]),
        ("src/arm/launch/left/arm.launch.py", [ARM]),
        ("base.launch", [BASE, OTHER]),
        ("launch/left/arm.launch.py", [ARM]),
        ("arm arm.launch.py", [ARM]),
        ("arm base.launch", []),
        ("se.launch", []),
    ],
)
def test_launch_files_have_names_paths_and_ends_of_both(text: str, expected: list[SystemName]) -> None:
    """Names and paths match in full or by their last segments; a package and a file match as for roslaunch."""
    assert matching(NAMES, text) == expected


def test_a_file_on_disk_is_found_in_its_source(tmp_path: Path) -> None:
    """The path of a file refers to the launch file of its source, even if others have the same name."""
    file = tmp_path / BASE.path
    file.parent.mkdir(parents=True)
    file.touch()
    assert find(NAMES, str(file), {"base": str(tmp_path)}) == BASE


def test_what_several_are_called_is_refused_with_all_of_them() -> None:
    """KG003 lists the full names."""
    with pytest.raises(UsageError, match="2 launch files are called") as caught:
        find(NAMES, "base.launch", {})
    assert caught.value.hint is not None
    assert BASE.name in caught.value.hint
    assert OTHER.name in caught.value.hint


_FOLDERS = st.lists(st.sampled_from(("a", "b", "launch")), max_size=3).map(lambda parts: "/".join([*parts, "x.launch"]))


@given(
    st.lists(
        st.builds(SystemName, st.sampled_from(("one", "two")), _FOLDERS, _FOLDERS, st.just(1)),
        min_size=2,
        max_size=6,
        unique_by=lambda one: (one.repository, one.path),
    )
)
def test_each_way_that_is_offered_leads_to_one_launch_file(names: list[SystemName]) -> None:
    """KG003 lists each launch file once, by an unambiguous text, also for equal names and paths."""
    several = matching(names, "x.launch")
    assume(len(several) > 1)
    with pytest.raises(UsageError, match="KG003") as caught:
        find(names, "x.launch", {})
    ways = re.findall(r"`--launch (.*?)`", caught.value.hint or "")
    meant = [find(names, way, {}) for way in ways]
    assert sorted(meant, key=names.index) == several


def test_what_none_is_called_is_refused_with_what_was_meant() -> None:
    """KG422 suggests a similar name."""
    with pytest.raises(UnknownNameError, match="KG422") as caught:
        find(NAMES, "bringup/launch/bas.launch", {})
    assert caught.value.hint is not None
    assert BASE.name in caught.value.hint


def test_assignments_are_names_and_values() -> None:
    """The first separator splits them; a text without it, or without a name, is refused."""
    assert assignments(["x:=1", "y:=a:=b", "z:="]) == {"x": "1", "y": "a:=b", "z": ""}
    assert assignments(["HOME=/root"], "=") == {"HOME": "/root"}
    for text in ("x", ":=1"):
        with pytest.raises(UsageError, match="KG003"):
            assignments([text])


def test_arguments_need_the_launch_file_that_they_are_for() -> None:
    """Arguments and environment variables are refused without a launch file, and accepted with one."""
    check_given(None, {}, {})
    check_given("x.launch", {"a": "1"}, {})
    for arguments, environment in ((["a:=1"], []), ([], ["A:=1"])):
        with pytest.raises(UsageError, match="KG003: arguments are for one launch file"):
            check_given(None, assignments(arguments), assignments(environment))
