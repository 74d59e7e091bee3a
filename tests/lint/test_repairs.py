"""Edits that fix findings: the place of a name, and its replacement."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.lint.finding import Evidence, Finding
from kg.lint.lines import Lines
from kg.lint.repairs import places, repairs

if TYPE_CHECKING:
    from pathlib import Path


def repaired(folder: Path, finding: Finding) -> list[str]:
    """Return the lines after the fixes of a finding, with the names of their files."""
    lines = Lines({"mine": str(folder)})
    result = []
    for each in repairs(finding, lines):
        text = lines.at(each.place, each.line) or ""
        assert text[each.column :].startswith(each.written)
        new = text[: each.column] + each.text + text[each.column + len(each.written) :]
        result.append(f"{each.place.path}:{each.line} {new.strip()}")
    return result


def finding(place: Evidence, wrong: str, right: str, *evidence: Evidence) -> Finding:
    """Return a finding that one name should be another."""
    return Finding("KG401", "r", "warning", "s", "m", (wrong,), place, evidence, replacement=right)


@pytest.mark.parametrize(
    ("name", "text", "words", "wrong", "right", "expected"),
    [
        ("a.launch", '<remap from="image" to="imge"/>', "", "/imge", "/image", '<remap from="image" to="image"/>'),
        ("a.launch", '<remap from="i" to="/imge"/>', "", "/imge", "/image", '<remap from="i" to="/image"/>'),
        ("a.launch", '<r to="cam/imge"/>', "", "/r/cam/imge", "/r/cam/image", '<r to="cam/image"/>'),
        ("a.launch", '<remap from="i" to="imge"/>', "", "/r/imge", "/s/image", '<remap from="i" to="/s/image"/>'),
        ("a.launch", '<r to="$(arg r)/imge"/>', "", "/r/imge", "/r/image", '<r to="$(arg r)/image"/>'),
        ("a.launch", '<r to="$(arg r)/imge"/>', "", "/r/imge", "/s/image", None),
        ("a.launch", '<remap from="im" to="im"/>', "remaps /im to /im", "/im", "/is", '<remap from="im" to="is"/>'),
        ("a.launch", '<remap to="im" from="im"/>', "remaps /im to /i", "/im", "/is", '<remap to="im" from="is"/>'),
        ("a.launch", '<remap from="imge2" to="x_imge"/>', "", "/imge", "/image", None),
        ("a.launch.py", 'x=[("im", "im")]', "remaps im to im", "/im", "/is", 'x=[("im", "is")]'),
        ("a.py", 'rospy.get_param("~rte", 5)', "", "/node/rte", "/node/rate", 'rospy.get_param("~rate", 5)'),
        ("a.cpp", "imge::advertise<imge::T>();", "", "/imge", "/image", None),
        ("a.yaml", "rte: 5", "", "/node/rte", "/node/rate", "rate: 5"),
    ],
)  # fmt: skip
def test_a_line(tmp_path: Path, name: str, text: str, words: str, wrong: str, right: str, expected: str | None) -> None:  # noqa: PLR0913, PLR0917 - the columns of a table
    """The end of the wrong name becomes the same end of the right one; the rest is unchanged."""
    (tmp_path / name).write_text(f"\n{text}\n")
    found = repaired(tmp_path, finding(Evidence(name, 2, "mine", words), wrong, right))
    assert found == ([f"{name}:2 {expected}"] if expected else [])


def test_a_call_of_several_lines(tmp_path: Path) -> None:
    """The name may be in a later line of the call or element."""
    (tmp_path / "a.cpp").write_text('node.advertise<Image>(\n    "imge",\n    1);\nother("imge");\n')
    found = repaired(tmp_path, finding(Evidence("a.cpp", 1, "mine"), "/imge", "/image"))
    assert found == ['a.cpp:2 "image",']


def test_the_default_of_an_argument(tmp_path: Path) -> None:
    """If the line reads an argument, its value in the same file is replaced, if present."""
    line = '<remap from="i" to="$(arg topic)"/>\n'
    (tmp_path / "a.launch").write_text(f'<arg name="topic" default="imge"/>\n{line}')
    (tmp_path / "b.launch").write_text(f'<arg name="a" default="imge"/>\n<arg name="b" default="imge"/>\n{line}')
    one = repaired(tmp_path, finding(Evidence("a.launch", 2, "mine"), "/imge", "/image"))
    two = repaired(tmp_path, finding(Evidence("b.launch", 3, "mine"), "/imge", "/image"))
    assert (one, two) == (['a.launch:1 <arg name="topic" default="image"/>'], [])


def test_the_other_end(tmp_path: Path) -> None:
    """The other name may be the misspelt one: it is replaced at one of its ends."""
    (tmp_path / "a.launch").write_text('<remap from="i" to="image"/>\n<node name="image"/>\n')
    (tmp_path / "b.py").write_text('Publisher("imge", 1)\n')
    ends = Evidence("b.py", 1, "mine", "publishes imge"), Evidence("a.launch", 2, "mine", "starts /image")
    found = repaired(tmp_path, finding(Evidence("a.launch", 1, "mine"), "/image", "/imge", *ends))
    assert found == ['a.launch:1 <remap from="i" to="imge"/>', 'b.py:1 Publisher("image", 1)']


def test_a_name_in_the_code_of_a_node(tmp_path: Path) -> None:
    """If the line only starts the node, the name is marked and replaced in its code."""
    (tmp_path / "a.launch").write_text('<node name="viewer" ns="r"/>\n')
    (tmp_path / "b.cpp").write_text('create_subscription<Image>(\n  "imge", 1);\n')
    start, code = (
        Evidence("a.launch", 1, "mine", "starts /r/viewer"),
        Evidence("b.cpp", 1, "mine", "subscribes to imge"),
    )
    one = finding(start, "/r/imge", "/r/image", code)
    assert places(one, Lines({"mine": str(tmp_path)})) == [start, code]
    assert repaired(tmp_path, one) == ['b.cpp:2 "image", 1);']
