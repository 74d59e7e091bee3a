"""Any launch files are evaluated completely, within limits and without an error."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from files.ros1.generator import launch_tree
from files.ros1.records import evaluated
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kg.facts import LaunchProblemKind
from kg.launch.files.ros1.parameterfile import read_tree

if TYPE_CHECKING:
    from pathlib import Path

    from kg.facts import LaunchConfiguration

WORDS = [
    "<launch>",
    "</launch>",
    "<node pkg='p' type='t' name='",
    "'/>",
    "<group ns='a'>",
    "</group>",
    "$(arg ",
    "$(eval ",
    ")",
]
WORDS += [
    "<arg name='x' default='",
    "<include file='$(find demo)/main.launch'/>",
    "<rosparam>",
    "</rosparam>",
    "a: [",
    "{",
    "}",
    "\n",
]
WORDS += [
    "<param name='~p' value='",
    " if='$(arg x)'",
    "<remap from='a' to='",
    "&amp;",
    "<!--",
    "-->",
    "x",
    "1",
    "'",
    "\x00",
    "é",
]
SLOW = settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow]
)


def kinds(found: LaunchConfiguration) -> set[LaunchProblemKind]:
    """Return the kinds of all problems."""
    return {one.kind for one in found.problems}


@given(st.lists(st.sampled_from(WORDS), max_size=25).map("".join))
@SLOW
def test_any_text_is_evaluated(tmp_path: Path, text: str) -> None:
    """Any content of a file gives a configuration."""
    assert evaluated(tmp_path, {"main.launch": text}).path == "demo/main.launch"


@given(st.integers(10_000, 10**6), st.sampled_from(["", "unknown", "1"]))
@settings(SLOW, max_examples=25)
def test_any_tree_is_evaluated_alike(tmp_path: Path, seed: int, value: str) -> None:
    """A tree gives the same configuration each time."""
    tree = launch_tree(Random(seed))  # noqa: S311 - no secret
    tree["main.launch"] = tree["f0.launch"]
    given_values = {"a": value} if value else {}
    assert evaluated(tmp_path, tree, given_values) == evaluated(tmp_path, tree, given_values)


def test_doubling_texts(tmp_path: Path) -> None:
    """Arguments that repeat each other stop growing, which is reported."""
    lines = [f"<arg name='a{n}' default='$(arg a{n - 1})$(arg a{n - 1})'/>" for n in range(1, 60)]
    found = evaluated(tmp_path, {"main.launch": f"<launch><arg name='a0' default='xx'/>{''.join(lines)}</launch>"})
    assert kinds(found) == {LaunchProblemKind.LIMIT}
    assert max(len(one.value or "") for one in found.arguments) <= 1 << 16


def test_includes_that_fan_out(tmp_path: Path) -> None:
    """Evaluation of files that include each other many times terminates."""
    includes = {n: f"<include file='$(find demo)/f{n + 1}.launch'/>" * 8 for n in range(12)}
    tree = {f"f{n}.launch": f"<launch>{text}</launch>" for n, text in includes.items()}
    found = evaluated(tmp_path, {**tree, "main.launch": tree["f0.launch"], "f12.launch": "<launch/>"})
    assert LaunchProblemKind.LIMIT in kinds(found)


def test_recursion_that_counts_up(tmp_path: Path) -> None:
    """A file that includes itself with other arguments each time is stopped."""
    include = "<include file='$(find demo)/main.launch'><arg name='n' value='$(eval n + 1)'/></include>"
    groups = "<group>" * 50, "</group>" * 50
    text = f"<launch><arg name='n' default='1'/>{groups[0]}{include}{groups[1]}{include}</launch>"
    assert LaunchProblemKind.LIMIT in kinds(evaluated(tmp_path, {"main.launch": text}))


def test_a_file_that_includes_itself(tmp_path: Path) -> None:
    """A cycle is reported, with the file at its start."""
    found = evaluated(tmp_path, {"main.launch": "<launch>\n<include file='$(find demo)/main.launch'/>\n</launch>"})
    (problem,) = found.problems
    assert (problem.kind, problem.subject, problem.location.line) == (LaunchProblemKind.CYCLE, "demo/main.launch", 2)


def test_entities_are_refused(tmp_path: Path) -> None:
    """Entities that a file defines are never expanded."""
    text = '<!DOCTYPE l [<!ENTITY a "x"><!ENTITY b "&a;&a;">]>\n<launch><node pkg="&b;" type="t" name="n"/></launch>'
    found = evaluated(tmp_path, {"main.launch": text})
    assert kinds(found) == {LaunchProblemKind.MALFORMED}
    assert not found.nodes


def test_lines_of_long_files(tmp_path: Path) -> None:
    """Lines after 65535 are right, and an element has the line of its start."""
    text = "<launch>" + "\n" * 70_000 + "<node\n  pkg='p'\n  type='t'\n  name='n'/>\n</launch>"
    (node,) = evaluated(tmp_path, {"main.launch": text}).nodes
    assert node.location.line == 70_001


def test_deep_elements(tmp_path: Path) -> None:
    """Excessively nested elements are not read."""
    found = evaluated(tmp_path, {"main.launch": "<launch>" + "<group>" * 50_000})
    assert kinds(found) == {LaunchProblemKind.MALFORMED}


def test_yaml_that_repeats_itself(tmp_path: Path) -> None:
    """Aliases that expand to billions of values are cut off, which is reported."""
    lines = ["a0: &a0 {x: 1}", *(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, 12))]
    found = evaluated(
        tmp_path,
        {"main.launch": "<launch><rosparam file='$(find demo)/p.yaml'/></launch>", "p.yaml": "\n".join(lines)},
    )
    assert kinds(found) == {LaunchProblemKind.LIMIT}
    assert sum(len(one.value or "") for one in found.parameters) < 1 << 20


def test_deep_and_large_parameter_files(tmp_path: Path) -> None:
    """Parameter files with deep nesting, large size or unbounded numbers are problems."""
    files = {
        "deep": "a: " + "[" * 100_000,
        "large": "a: 1\n" * 300_000,
        "sixty": "a: 1" + ":1" * 200_000,
        "hex": "a: 0x" + "f" * 4000,
    }
    loads = "".join(f"<rosparam file='$(find demo)/{name}.yaml'/>" for name in files)
    tree = {f"{name}.yaml": text for name, text in files.items()}
    found = evaluated(
        tmp_path, {"main.launch": f"<launch>{loads}<param name='x' value='{'9' * 5000}'/></launch>", **tree}
    )
    assert kinds(found) <= {LaunchProblemKind.LIMIT, LaunchProblemKind.MALFORMED}
    assert [one.name for one in found.parameters if one.value] == []


def test_many_nodes_and_parameters(tmp_path: Path) -> None:
    """Nodes above the limit of a configuration are dropped."""
    nodes = "<node pkg='p' type='t' name='n'/>" * 20_010
    found = evaluated(tmp_path, {"main.launch": f"<launch>{nodes}</launch>"})
    assert len(found.nodes) == 20_000
    assert kinds(found) == {LaunchProblemKind.LIMIT}


def test_names_that_no_file_can_have(tmp_path: Path) -> None:
    """Names that are too long, or have invalid characters, lead to no file."""
    strange = ["$(find " + "x" * 5000 + ")/a", "$(find demo)/" + "y" * 5000, "$(eval '/\\x00')", "$(eval '\\ud800')"]
    text = "".join(f'<include file="{one}"/><param name="p" textfile="{one}"/>' for one in strange)
    found = evaluated(tmp_path, {"main.launch": f"<launch>{text}</launch>"})
    assert all(one.path is None for one in found.includes)
    assert len(found.includes) == len(strange)


def test_a_tag_that_yaml_does_not_know_is_malformed() -> None:
    """A value of an unknown tag stops the parsing of its text, and is reported with its line."""
    tree = read_tree("a: 1\nb: !include c\nd: 2\n")
    assert [leaf.keys for leaf in tree.leaves] == [("a",)]
    assert [line for _, line in tree.problems] == [2]
    assert not tree.too_large
