"""Tests of choosing branches; the cases are in a file."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any, Final

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.corpus.fetching.one import VERSIONS, branches_to_try, marked

CASES: Final = tomllib.loads((Path(__file__).parent / "cases" / "branches" / "cases.toml").read_text("utf-8"))["case"]
NAMES = st.lists(st.sampled_from(["main", "master", "ros2", "noetic-devel", "humble", "foxy-devel", "x", "hydro"]))


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case["about"])
def test_branches(case: dict[str, Any], version: str) -> None:
    """The branches of a server give the candidates for a version."""
    default = case["branches"][0] if case.get("default", True) else None
    assert list(branches_to_try(default, case["branches"], version)) == case[version]


@given(NAMES, st.sampled_from(VERSIONS))
def test_only_branches_that_are_there(names: list[str], version: str) -> None:
    """Each candidate exists, is listed once, and is not marked for the other version."""
    found = branches_to_try(names[0] if names else None, names, version)
    assert len(set(found)) == len(found)
    assert set(found) <= set(names)
    assert version == "any" or all(marked(name) in {None, version} for name in found)
