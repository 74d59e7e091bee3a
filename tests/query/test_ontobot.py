"""The competency questions of OntoBOT, unchanged, over inferences about the example systems.

Questions 1 to 3, and the first halves of the others, are about activities, which the graph of `kg` does not contain;
they are asked over activities in the terms of OntoBOT. The second halves of 4, 5 and 6 are about capabilities of
robots.
"""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from pyoxigraph import QuerySolutions, RdfFormat, Store

if TYPE_CHECKING:
    from kg.store.snapshot import EmbeddedSnapshot

FOLDER = Path(__file__).parent / "ontobot"
PREFIXES = {"prov": "http://www.w3.org/ns/prov#"}
"""Bound to the graphs in the notebook, and not declared in question 5."""
SOMA = "http://www.ease-crc.org/ont/SOMA.owl#"
ROBOTS = {
    "rover_robot/launch/rover.launch": {"LookingAt"},
    "drone_control/launch/drone.launch.py": {"LookingAt"},
    "drone_mission/launch/mission.launch.xml": {"LookingAt", "Navigating"},
    "eyes/launch/eyes.launch": {"LookingAt"},
}


@pytest.fixture(scope="module")
def activities() -> Store:
    """Return two activities in the terms of OntoBOT."""
    store = Store()
    store.load(path=FOLDER / "activities.ttl", format=RdfFormat.TURTLE)
    return store


def asked(of: Store | EmbeddedSnapshot, name: str) -> list[tuple[str, ...]]:
    """Return the rows of a question, with local names for the terms of SOMA, sorted."""
    rows = of.query((FOLDER / f"{name}.rq").read_text("utf-8"), prefixes=PREFIXES)
    assert isinstance(rows, QuerySolutions)
    return sorted(tuple(str(getattr(term, "value", "")).removeprefix(SOMA) for term in row) for row in rows)


def able(examples: EmbeddedSnapshot, name: str) -> dict[str, set[str]]:
    """Return the affordances of each robot, by its label."""
    found: defaultdict[str, set[str]] = defaultdict(set)
    for robot, affordance in asked(examples, name):
        found[robot].add(affordance)
    return dict(found)


@pytest.mark.parametrize("name", ["cq4-part2", "cq5-part2", "cq6-part2"])
def test_which_robot_affords_what(examples: EmbeddedSnapshot, name: str) -> None:
    """Launched systems are robots, with the affordances enabled by their capabilities."""
    assert able(examples, name) == ROBOTS


def test_which_robot_can_do_an_activity(examples: EmbeddedSnapshot, activities: Store) -> None:
    """CQ 4: all four can look, which is the only requirement for tidying up here."""
    required = {affordance for (affordance,) in asked(activities, "cq4-part1")}
    assert required == {"LookingAt"}
    assert {robot for robot, found in able(examples, "cq4-part2").items() if required <= found} == set(ROBOTS)


def test_which_robot_can_do_both_activities(examples: EmbeddedSnapshot, activities: Store) -> None:
    """CQ 5: none can pour, so none can do both."""
    required = {affordance for (affordance,) in asked(activities, "cq5-part1")}
    assert required == {"LookingAt", "Navigating", "Pouring"}
    assert not [robot for robot, found in able(examples, "cq5-part2").items() if required <= found]


def test_what_robots_lack_for_which_step(examples: EmbeddedSnapshot, activities: Store) -> None:
    """CQ 6: the rover does not go to a table, and no robot pours."""
    steps = asked(activities, "cq6-part1")
    lacking = {
        robot: [step for _, step, affordance in steps if affordance not in found]
        for robot, found in able(examples, "cq6-part2").items()
    }
    assert lacking == {
        "rover_robot/launch/rover.launch": ["Drive to the table", "Pour milk"],
        "drone_control/launch/drone.launch.py": ["Drive to the table", "Pour milk"],
        "drone_mission/launch/mission.launch.xml": ["Pour milk"],
        "eyes/launch/eyes.launch": ["Drive to the table", "Pour milk"],
    }


def test_questions_about_activities(examples: EmbeddedSnapshot, activities: Store) -> None:
    """CQ 1 to 3 are answered by activities, and by nothing in the graph of kg."""
    assert [affordance for _, affordance in asked(activities, "cq1")] == ["Pouring", "Navigating"]
    assert {action for *_, action in asked(activities, "cq2")} == {"Drive", "Pour"}
    assert len(asked(activities, "cq3")) == 3
    assert not [row for name in ("cq1", "cq2", "cq3") for row in asked(examples, name)]
