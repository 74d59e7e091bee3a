from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
import yaml
from extract.workspaces import codes, reader_of
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kg.extract.parameters import read_generated
from kg.facts import Access, Resolution
from kg.holes import is_partial

if TYPE_CHECKING:
    from pathlib import Path

    from kg.corpus.reading import Reader
    from kg.facts import Parameter

PATH = "demo/config/params.yaml"


def read(root: Path, text: str | bytes) -> tuple[tuple[Parameter, ...], Reader]:
    """Return the parameters of a file with this text, and the reader that read it."""
    reader = reader_of(root, {"config/params.yaml": text})
    return read_generated(reader, PATH), reader


TEXT = """controller:
  joints:
    type: string_array
    default_value: ["left wheel", right]
    read_only: true
    description: " Which joints. "
  limits:
    max: {type: double, default_value: .inf}
    type: {type: string_fixed_20, default_value: "x"}
  gains:
    __map_joints:
      p: {type: double}
  filter_chain: {type: none, description: read by the filters}
"""


def test_names_types_defaults_and_lines(tmp_path: Path) -> None:
    """Each leaf with a type is a parameter, below the top key, with its names joined by dots and its own line."""
    found, _ = read(tmp_path, TEXT)
    assert [(p.name, p.type, p.default, p.location.line) for p in found] == [
        ("joints", "string_array", '["left wheel", right]', 2),
        ("limits.max", "double", ".inf", 8),
        ("limits.type", "string", '"x"', 9),
        ("gains.{joints}.p", "double", None, 12),
        ("filter_chain", None, None, 13),
    ]
    assert found[0].description == "Which joints."


def test_a_level_that_runs_over_other_parameters_is_a_hole(tmp_path: Path) -> None:
    """A name below `__map_` is only partly known."""
    found, _ = read(tmp_path, TEXT)
    assert [p.resolution for p in found if is_partial(p.name or "")] == [Resolution.PARTIAL]


def test_a_documented_parameter_is_not_declared(tmp_path: Path) -> None:
    """`type: none` documents a parameter read by other code."""
    found, _ = read(tmp_path, TEXT)
    assert [p.access for p in found] == [Access.DECLARE] * 4 + [Access.READ]


def test_malformed_yaml_is_reported_with_its_line(tmp_path: Path) -> None:
    """Invalid YAML is a problem KG119, without parameters."""
    found, reader = read(tmp_path, "a:\n  b: [1, 2\nc: }\n")
    assert found == ()
    assert codes(reader.problems) == [("KG119", 3)]


@pytest.mark.parametrize(
    "text",
    [
        "a: &a {b: *a}\n",
        "\n".join(["a0: &a0 {x: {type: int}}", *(f"a{n}: &a{n} {{l: *a{n - 1}, r: *a{n - 1}}}" for n in range(1, 40))]),
        "a:\n  p: {type: string, default_value: " + "[" * 100 + "]" * 100 + "}\n",
        "a: " + "{a: " * 3000 + "1" + "}" * 3000,
    ],
    ids=["endless alias", "aliases that double", "deep default", "deep file"],
)
def test_hostile_yaml_ends_and_is_reported(tmp_path: Path, text: str) -> None:
    """Unbounded aliases and nesting exhaust neither the build nor its memory."""
    _, reader = read(tmp_path, text)
    assert [code for code, _ in codes(reader.problems)] == ["KG119"]


NAMES = st.text("abcdefgh_", min_size=1, max_size=6).filter(lambda name: not name.startswith("__map_"))
LEAVES = st.fixed_dictionaries({"type": st.sampled_from(["bool", "double", "string_array"])})
TREES = st.dictionaries(NAMES, st.recursive(LEAVES, lambda t: st.dictionaries(NAMES, t, min_size=1, max_size=3)))


def leaves(tree: dict[str, object], above: tuple[str, ...] = ()) -> list[str]:
    """Return the dotted names of a tree's leaves in order."""
    found: list[str] = []
    for name, below in tree.items():
        if not isinstance(below, dict) or isinstance(below.get("type"), str):
            found.append(".".join((*above, name)))
        else:
            found.extend(leaves(below, (*above, name)))
    return found


@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], max_examples=40, deadline=None
)
@given(tree=TREES)
def test_every_leaf_is_a_parameter(tmp_path_factory: pytest.TempPathFactory, tree: dict[str, object]) -> None:
    """For any tree written as YAML, each leaf is found once under its dotted name."""
    found, _ = read(tmp_path_factory.mktemp("ws"), yaml.safe_dump({"top": tree}, sort_keys=False))
    assert [p.name for p in found] == leaves(tree)
