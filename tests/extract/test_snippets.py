"""Tests of the lines of code stored with facts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from extract.workspaces import manifest, written

from kg.pipeline.work import read_package

if TYPE_CHECKING:
    from pathlib import Path

    from kg.facts import Snippet


def quoted(root: Path, script: str) -> dict[str, Snippet]:
    """Return the snippets of a package with one script, by path."""
    workspace = written(root, {"demo/package.xml": manifest("demo"), "demo/scripts/talk.py": script})
    found = workspace.package("demo")
    assert found is not None
    return {one.path: one for one in read_package(workspace, *workspace.folder(found)).snippets}


def script(*lines: str) -> str:
    """Return a script that runs these lines in its node."""
    body = "".join(f"{line}\n" for line in lines)
    return f"#!/usr/bin/env python\nimport rospy\nfrom std_msgs.msg import String\nrospy.init_node('talk')\n{body}"


def test_lines_around_a_fact_are_kept(tmp_path: Path) -> None:
    """One line above and three below, and no others."""
    far = [f"x{number} = {number}" for number in range(10)]
    kept = dict(
        quoted(tmp_path, script(*far, "pub = rospy.Publisher('chatter', String)", *far))["demo/scripts/talk.py"].lines
    )
    assert [kept.get(number) for number in (14, 15, 18, 19)] == [
        "x9 = 9",
        "pub = rospy.Publisher('chatter', String)",
        "x2 = 2",
        None,
    ]


def test_lines_of_two_facts_are_kept_once(tmp_path: Path) -> None:
    """Overlapping regions are merged."""
    lines = [f"rospy.Publisher('a{number}', String)" for number in range(3)]
    numbers = [number for number, _ in quoted(tmp_path, script(*lines))["demo/scripts/talk.py"].lines]
    assert numbers == sorted(set(numbers))


@pytest.mark.parametrize(
    "line",
    [
        "password = 'hunter2'",
        "rospy.get_param('~api_key', 'hunter2')",
        "url = 'rtsp://admin:hunter2@10.0.0.1/'",
        "key = 'ghp_hunter2hunter2hunter2'",
    ],
)
def test_secrets_beside_a_fact_are_not_kept(tmp_path: Path, line: str) -> None:
    """Values after a secret-like word, in an address or in a key are removed."""
    kept = quoted(tmp_path, script(line, "rospy.Publisher('a', String)"))["demo/scripts/talk.py"].lines
    assert not any("hunter2" in text for _, text in kept)
    assert any("Publisher" in text for _, text in kept)


def test_a_secret_on_the_next_line_is_not_kept(tmp_path: Path) -> None:
    """A line that ends after a secret-like word hides the next one."""
    kept = quoted(tmp_path, script("secret = (", "  'hunter2')", "rospy.Publisher('a', String)"))
    assert not any("hunter2" in text for _, text in kept["demo/scripts/talk.py"].lines)


def test_a_file_has_a_bounded_number_of_lines(tmp_path: Path) -> None:
    """Lines of facts take precedence over surrounding ones."""
    lines = [part for number in range(300) for part in (f"rospy.Publisher('a{number}', String)", "", "", "")]
    kept = quoted(tmp_path, script(*lines))["demo/scripts/talk.py"].lines
    assert len(kept) == 400
    assert sum("Publisher" in text for _, text in kept) == 300


def test_long_lines_are_cut(tmp_path: Path) -> None:
    """A line is stored up to a limit."""
    kept = quoted(tmp_path, script("rospy.Publisher('a', String) # " + "long " * 100))["demo/scripts/talk.py"].lines
    assert max(len(text) for _, text in kept) == 201
