"""For any description the evaluation terminates, within limits and without raising."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from extract.workspaces import manifest, written
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kg.corpus.files import FilePath
from kg.corpus.reading import Reader
from kg.facts import LaunchProblemKind
from kg.launch.files.access import Files
from kg.launch.files.xacro.plugins import Descriptions, named_description

if TYPE_CHECKING:
    from pathlib import Path

    from kg.launch.files.xacro.plugins import Read

NAMES = st.sampled_from(["a", "b", "m", "n.m", "", "1", "plugin", "*a", "**b"])
TEXTS = st.sampled_from(
    [
        *("${a}", "${b + 1}", "${a", "$(arg a)", "$(arg", "$(find demo)/r.xacro", "$$", "$${a}", "true", "0", "'x'"),
        *("${a.b.c}", "${[1][5]}", "${a}${b}", "r.xacro", "*.xacro", "${load_yaml('r.xacro')}", "m:=^ *a", "{}"),
        "\ue000",
    ]
)
TAGS = st.sampled_from(
    [f"xacro:{name}" for name in ("property", "macro", "include", "if", "unless", "insert_block", "arg", "call", "m")]
    + ["xacro:element", "xacro:attribute", "plugin", "sensor", "macro", "property", "m", "gazebo"]
)
ATTRIBUTES = st.dictionaries(
    st.sampled_from(["name", "value", "params", "filename", "default", "scope", "ns", "macro", "a", "lazy_eval"]),
    TEXTS | NAMES,
    max_size=4,
)


def quoted(text: str) -> str:
    """Return a text escaped for an attribute."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")


def element(tag: str, attributes: dict[str, str], children: list[str]) -> str:
    """Return an element as text."""
    spelled = "".join(f' {name}="{quoted(text)}"' for name, text in attributes.items())
    return f"<{tag}{spelled}>{''.join(children)}</{tag}>"


ELEMENTS = st.recursive(
    st.builds(element, TAGS, ATTRIBUTES, st.just([])) | TEXTS.map(quoted),
    lambda inner: st.builds(element, TAGS, ATTRIBUTES, st.lists(inner, max_size=4)),
    max_leaves=30,
)


def read(root: Path, text: str | bytes, arguments: dict[str, str] | None = None) -> Read:
    """Return the result of the description `demo/r.xacro` with this text."""
    workspace = written(root, {"demo/package.xml": manifest("demo"), "demo/r.xacro": text})
    (source,) = workspace.sources
    file = FilePath(source.repository.name, "demo/r.xacro")
    return Descriptions(Files(Reader(workspace, source, source.packages[0])), file, {}).read(file, arguments or {}, ())


@given(parts=st.lists(ELEMENTS, max_size=8))
@settings(
    max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow]
)
def test_no_combination_of_commands_raises(tmp_path: Path, parts: list[str]) -> None:
    """Any nesting of commands gives a result, and the same one again."""
    text = f"<robot>{''.join(parts)}</robot>"
    assert read(tmp_path, text, {"a": "x"}) == read(tmp_path, text, {"a": "x"})


@given(text=st.binary(max_size=200) | st.text(max_size=200).map(str.encode))
@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow]
)
def test_any_text_can_be_read(tmp_path: Path, text: bytes) -> None:
    """A file need not be XML."""
    assert read(tmp_path, text).plugins == ()


BOMB = "".join(f'<xacro:property name="p{n + 1}" value="${{p{n}}}${{p{n}}}"/>' for n in range(60))


@pytest.mark.parametrize(
    "text",
    [
        '<r><xacro:macro name="m" params=""><xacro:m/><xacro:m/></xacro:macro><xacro:m/></r>',
        '<r><xacro:macro name="a" params="*b"><xacro:a><xacro:insert_block name="b"/></xacro:a></xacro:macro><a/></r>',
        "<r>" + "<a>" * 500 + "</a>" * 500 + "</r>",
        '<!DOCTYPE r [<!ENTITY x "y">]><r>&x;</r>',
    ],
    ids=["macros", "blocks", "depth", "entities"],
)
def test_what_grows_without_end_is_cut_and_named(tmp_path: Path, text: str) -> None:
    """Macros that call themselves, and elements nested too deep, end with a problem."""
    found = read(tmp_path, text.replace("<r>", '<r xmlns:xacro="http://www.ros.org/wiki/xacro">'))
    assert {one.kind for one in found.problems} <= {LaunchProblemKind.LIMIT, LaunchProblemKind.MALFORMED}
    assert found.problems


def test_texts_that_double_are_cut(tmp_path: Path) -> None:
    """A text that grows too long is unknown."""
    text = f'<r><xacro:property name="p0" value="x_"/>{BOMB}<plugin filename="a.so" name="${{p60}}"/></r>'
    (found,) = read(tmp_path, text).plugins
    assert found.name is not None
    assert len(found.name) <= 1000


def test_a_property_that_depends_on_itself_is_not_known(tmp_path: Path) -> None:
    """Circular definitions are not evaluated."""
    text = '<r><xacro:property name="a" value="${b}"/><xacro:property name="b" value="${a}"/>'
    (found,) = read(tmp_path, f'{text}<plugin filename="${{a}}.so"/></r>').plugins
    assert found.library == "{}.so"


def test_arguments_of_a_command_line_are_those_with_a_sign() -> None:
    """Options and the file are not arguments."""
    words = ["/opt/bin/xacro", "--inorder", "robot.xacro", "a:=b", "c:="]
    assert named_description(words) == ("robot.xacro", {"a": "b", "c": ""})
