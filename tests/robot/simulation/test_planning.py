from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

from kg.robot.simulation.navigating import Follower, Grid, Planner, free_ahead
from kg.robot.simulation.plan import PLANS, read_plan
from kg.robot.simulation.robots import Pose

OFFICE = read_plan("office")
RADIUS = 0.2
PLANNER = Planner(OFFICE, RADIUS)
COARSE = Grid(OFFICE, 0.1).near(RADIUS - 0.05)
GRID = Grid(OFFICE, 0.1)


def blocked(x: float, y: float) -> bool:
    """Whether a robot at a point touches an obstacle."""
    return bool(COARSE[GRID.cell(x, y)])


@pytest.mark.parametrize("name", PLANS)
def test_plans_are_sound(name: str) -> None:
    """Names of rooms and numbers of tags are unique, and everything is within the walls."""
    plan = read_plan(name)
    assert len({one.name for one in plan.rooms}) == len(plan.rooms)
    assert len({one.id for one in plan.tags}) == len(plan.tags)
    places = [(one.place.x, one.place.y) for one in plan.rooms] + [(one.x, one.y) for one in plan.tags]
    assert all(0 < x < plan.width and 0 < y < plan.depth for x, y in places)
    assert all(one.holds(one.place.x, one.place.y) for one in plan.rooms)


def test_every_room_but_the_archive_can_be_reached() -> None:
    """Every place can be reached from the start; the archive has no door."""
    start = OFFICE.start.x, OFFICE.start.y
    lost = [one.name for one in OFFICE.rooms if PLANNER.way(start, (one.place.x, one.place.y)) is None]
    assert lost == ["archive"]


@settings(max_examples=30, deadline=None)
@given(
    start=some.tuples(some.floats(0.5, 11.5), some.floats(0.5, 8.5)),
    goal=some.tuples(some.floats(-1, 13), some.floats(-1, 10)),
)
def test_ways_are_free(start: tuple[float, float], goal: tuple[float, float]) -> None:
    """A way ends at the goal, without obstacles."""
    way = PLANNER.way(start, goal)
    if way is None:
        return
    assert way[-1] == goal
    for (x, y), (to_x, to_y) in pairwise(way):
        steps = max(1, int(math.dist((x, y), (to_x, to_y)) / 0.05))
        shares = [index / steps for index in range(steps + 1)]
        assert not any(blocked(x + share * (to_x - x), y + share * (to_y - y)) for share in shares)


def test_the_map_has_walls_and_doors() -> None:
    """A square of a wall is occupied, one of a door and one of the floor are free."""
    taken = GRID.taken
    assert taken[GRID.cell(4.0, 1.0)]
    assert not taken[GRID.cell(2.0, 3.6)]
    assert not taken[GRID.cell(6.0, 4.5)]
    assert set(GRID.occupancy()) == {0, 100}


def test_a_wall_ahead_stops_the_follower() -> None:
    """With an obstacle in front the follower requests no speed, whatever the way."""
    ranges = [0.25] * 120
    assert free_ahead(ranges) < 0.1
    command = Follower([(5.0, 0.0)], 0.0).next(Pose(0.0, 0.0, 0.0), ranges)
    assert command.forward == 0


def test_a_goal_behind_is_turned_to_first() -> None:
    """The follower turns on the spot before it drives."""
    command = Follower([(-5.0, 0.1)], 0.0).next(Pose(0.0, 0.0, 0.0), [math.inf] * 120)
    assert command.forward == 0
    assert command.turn > 0
