from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kg.corpus.files import FilePath
from kg.corpus.reading import Reader
from kg.corpus.workspace import Workspace, scan
from kg.facts import LaunchProblemKind, Repository
from kg.launch.files.access import MOST, Files
from kg.launch.files.ros2.execute import dialect_of, evaluate

if TYPE_CHECKING:
    from pathlib import Path

    from kg.facts import LaunchConfiguration

MANIFEST = '<package format="3"><name>demo</name></package>'
NODE = '<node pkg="p" exec="e" name="n"><param from="$(dirname)/p.yaml"/></node>'
DOUBLED = "".join(f", &c{i} [*c{i - 1}, *c{i - 1}]" for i in range(1, 36))
NESTED = "\n".join(f"a{i}: &a{i} {{p: *a{i - 1}, q: *a{i - 1}}}" for i in range(1, 40))


def evaluated(folder: Path, files: dict[str, str]) -> LaunchConfiguration:
    """Write a package and return the result of its first file."""
    for name, text in {"package.xml": MANIFEST, **files}.items():
        (folder / name).write_text(text)
    source = scan(folder, Repository("local/demo", str(folder)))
    file = FilePath("local/demo", next(iter(files)))
    dialect = dialect_of(file, next(iter(files.values())).encode())
    return evaluate(Files(Reader(Workspace([source]), source, source.packages[0])), file, dialect, {}, {})


def include(number: int) -> str:
    """Return a file that includes the next one twice."""
    return "<launch>" + f'<include file="$(dirname)/f{number}.launch.xml"/>' * 2 + "</launch>"


def launch(*elements: str) -> str:
    """Return a launch file of elements."""
    return f"<launch>{''.join(elements)}</launch>"


CHAIN = {
    f"f{number}.launch.xml": launch(f'<include file="$(dirname)/f{number + 1}.launch.xml"/>') for number in range(103)
}
GROWTH = '<let name="x" value="$(var x)$(var x)"/>'
FIVE_HUNDRED = ", ".join(f"p{number}: 1" for number in range(500))
CASES = {
    "fan": {f"f{number}.launch.xml": include(number + 1) for number in range(40)},
    "depth": CHAIN,
    "growth": {"a.launch.xml": launch('<let name="x" value="abc"/>', GROWTH * 60)},
    "nodes": {"a.launch.xml": launch(NODE * 101), "p.yaml": ""},
    "parameters": {"a.launch.xml": launch(NODE * 5), "p.yaml": f"n: {{ros__parameters: {{{FIVE_HUNDRED}}}}}"},
}

GROUPS = "\n".join(f"- &a{i} {{group: [*a{i - 1}, *a{i - 1}, *a{i - 1}]}}" for i in range(1, 40))
MALFORMED = {
    "aliases of actions": {"a.launch.yaml": f"launch:\n- &a0 {{log: {{message: x}}}}\n{GROUPS}"},
    "aliases of nodes": {
        "a.launch.xml": launch(NODE),
        "p.yaml": f"a0: &a0 {{x: 1}}\n{NESTED}\nn:\n  ros__parameters: *a39",
    },
    "aliases of values": {
        "a.launch.xml": launch(NODE),
        "p.yaml": f"b: [&c0 [1]{DOUBLED}]\nn: {{ros__parameters: {{x: *c35}}}}",
    },
    "groups": {"a.launch.xml": launch("<group>" * 150, "</group>" * 150)},
    "deep operands": {"a.launch.xml": launch(f'<let name="a" value="{"$(var " * 50}x{")" * 50}"/>')},
}


@pytest.mark.parametrize("case", CASES)
def test_what_grows_without_end_is_cut_and_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, case: str) -> None:
    """Includes, texts, nodes and parameters are bounded, and a problem names the reached limit."""
    for what, most in {"actions": 1_000, "nodes": 100, "parameters": 2_000}.items():
        monkeypatch.setitem(MOST, what, most)
    assert LaunchProblemKind.LIMIT in {problem.kind for problem in evaluated(tmp_path, CASES[case]).problems}


@pytest.mark.parametrize("case", MALFORMED)
def test_files_that_expand_endlessly_are_malformed(tmp_path: Path, case: str) -> None:
    """Aliases of YAML, nested elements and nested substitutions are bounded."""
    assert [problem.kind for problem in evaluated(tmp_path, MALFORMED[case]).problems] == [LaunchProblemKind.MALFORMED]


def test_characters_that_are_no_text_are_not_known(tmp_path: Path) -> None:
    """No expression gives a text that cannot be written to a file, also in a file of parameters."""
    strange = "$(eval 'chr(0xd800)')"
    node = f'<node pkg="p" exec="e" name="n{strange}"><param from="$(dirname)/p.yaml" allow_substs="true"/></node>'
    content = f"/**:\n  ros__parameters:\n    a: x{strange}\n"
    found = evaluated(tmp_path, {"a.launch.xml": launch(node), "p.yaml": content})
    assert [(one.name, one.parameters[0].value) for one in found.nodes] == [("n{}", "x{}")]
    assert {problem.kind for problem in found.problems} == {LaunchProblemKind.UNRESOLVED}


TAGS = st.sampled_from(["node", "arg", "let", "group", "include", "param", "remap", "executable", "set_remap", "x"])
TEXTS = st.sampled_from(
    ["", "a", "$(var a)", "$(", "$(eval '1/0')", "{}", "true", "$(dirname)/b.launch.xml", "[1, a", "/ns"]
)
NAMES = ["name", "value", "default", "if", "unless", "pkg", "exec", "file", "from", "to", "cmd", "args", "type"]
ATTRIBUTES = st.dictionaries(st.sampled_from(NAMES), TEXTS, max_size=6)


def element(tag: str, attributes: dict[str, str], children: list[str]) -> str:
    """Write an element."""
    written = "".join(f' {name}="{value}"' for name, value in attributes.items())
    return f"<{tag}{written}>{''.join(children)}</{tag}>"


ELEMENTS = st.recursive(
    st.builds(element, TAGS, ATTRIBUTES, st.just([])),
    lambda below: st.builds(element, TAGS, ATTRIBUTES, st.lists(below, max_size=3)),
    max_leaves=8,
)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], deadline=None)
@given(st.lists(ELEMENTS, max_size=5))
def test_no_launch_file_makes_evaluation_fail(tmp_path: Path, elements: list[str]) -> None:
    """Any elements with any attributes give a configuration, possibly with problems."""
    found = evaluated(tmp_path, {"a.launch.xml": f"<launch>{''.join(elements)}</launch>", "b.launch.xml": "<launch/>"})
    assert found.path == "a.launch.xml"
