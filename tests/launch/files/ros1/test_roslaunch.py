"""kg and roslaunch give the same nodes, names, remappings, parameters and faults for launch files.

Runs where the system's Python has roslaunch (Debian's `python3-roslaunch`).
"""

from __future__ import annotations

import json
from random import Random
from typing import TYPE_CHECKING

import pytest
from extract.workspaces import manifest, written
from files.ros1.comparison import ask, differences, job, reason_to_skip
from files.ros1.generator import launch_tree
from files.ros1.records import CASES, case_workspace, configuration

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.ros

TREES = 80
ENVIRONMENT = {"HOME_OF": "5"}


@pytest.fixture(scope="module", autouse=True)
def _roslaunch() -> None:
    """Skip if roslaunch is not installed."""
    if reason := reason_to_skip():
        pytest.skip(reason)


def test_cases_agree(tmp_path: Path) -> None:
    """Each case is loaded by roslaunch, or rejected where kg reports a fault."""
    jobs, found = [], []
    for case in CASES:
        expected = json.loads(case.read_text(encoding="utf-8"))
        given, environment = expected.get("given", {}), expected.get("environment", {})
        workspace = case_workspace(tmp_path / case.parent.name, case.parent)
        found.append(configuration(workspace, expected["launch"], given, environment))
        jobs.append(job(workspace, found[-1], environment))
    results = zip(CASES, found, ask(jobs), strict=True)
    unlike = {case.parent.name: differences(ours, theirs) for case, ours, theirs in results}
    assert {name: words for name, words in unlike.items() if words} == {}


def test_trees_at_random_agree(tmp_path: Path) -> None:
    """Random launch trees give the same result in roslaunch, and its rejections are problems."""
    jobs, found = [], []
    for seed in range(TREES):
        tree = {f"demo/{path}": text for path, text in launch_tree(Random(seed)).items()}  # noqa: S311 - no secret
        workspace = written(tmp_path / str(seed), {"demo/package.xml": manifest("demo"), **tree})
        found.append(configuration(workspace, "demo/f0.launch", {}, ENVIRONMENT))
        jobs.append(job(workspace, found[-1], ENVIRONMENT))
    results = ask(jobs)
    unlike = {seed: differences(ours, theirs) for seed, (ours, theirs) in enumerate(zip(found, results, strict=True))}
    assert {seed: words for seed, words in unlike.items() if words} == {}
    assert sum("error" not in one for one in results) > TREES / 2
