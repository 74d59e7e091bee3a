from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

from kg.robot.simulation.drone import Drone, State
from kg.robot.simulation.robots import Command
from kg.robot.simulation.scene import TAG_SIZE, find_tags
from kg.robot.simulation.wheeled import RADIUS, Wheeled
from kg.robot.simulation.world import World

if TYPE_CHECKING:
    from collections.abc import Iterator

pytest.importorskip("pybullet", reason="worlds need pybullet")
pytest.importorskip("cv2", reason="tags need OpenCV")


@pytest.fixture
def office() -> Iterator[World]:
    """Yield the office with its robot."""
    with World("office") as world:
        yield world


@pytest.fixture
def field() -> Iterator[World]:
    """Yield the field with its drone."""
    with World("drone") as world:
        yield world


def wheeled(world: World) -> Wheeled:
    """Return the robot of the office."""
    assert isinstance(world.robot, Wheeled)
    return world.robot


def drone(world: World) -> Drone:
    """Return the drone of the field."""
    assert isinstance(world.robot, Drone)
    return world.robot


def touches(world: World) -> bool:
    """Whether the robot touches an obstacle now."""
    return world.robot.bumped if isinstance(world.robot, Wheeled | Drone) else False


def state(craft: Drone) -> State:
    """Return the current state of a drone."""
    return craft.state


def drive(world: World, seconds: float, command: Command | None = None) -> None:
    """Advance time, with an optional command renewed in every step."""
    end = world.time + seconds
    while world.time < end:
        if command and isinstance(world.robot, Wheeled | Drone):
            world.robot.command(Command(command.forward, command.left, command.up, command.turn, world.time))
        world.advance()


def test_the_robot_drives_as_it_is_told(office: World) -> None:
    """The distance matches the speed, and a turn rotates it."""
    drive(office, 5, Command(forward=0.5))
    assert office.robot.pose.x == pytest.approx(1 + 5 * 0.5, abs=0.15)
    drive(office, 2, Command(turn=math.pi / 4))
    assert office.robot.pose.heading == pytest.approx(math.pi / 2, abs=0.1)


def test_a_command_that_is_not_renewed_ends(office: World) -> None:
    """Half a second after the last command the robot brakes."""
    drive(office, 1, Command(forward=0.5))
    drive(office, 2)
    stood = office.robot.pose
    drive(office, 1)
    assert office.robot.pose == stood


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_speed_that_is_no_number_is_none(office: World, value: float) -> None:
    """A non-finite speed does not reach the physics."""
    drive(office, 0.5, Command(forward=value, turn=value))
    assert office.robot.pose.x == pytest.approx(1)


def test_walls_stop_the_robot(office: World) -> None:
    """It touches the wall at the end of the corridor, stays there, and can drive back."""
    drive(office, 20, Command(forward=0.8))
    assert touches(office)
    assert office.robot.pose.x == pytest.approx(12 - 0.05 - RADIUS, abs=0.02)
    drive(office, 2, Command(forward=-0.5))
    assert not touches(office)
    assert office.robot.pose.x < 11.2


def test_the_laser_measures_the_walls(office: World) -> None:
    """It sees the walls of the corridor behind, to the left and to the right."""
    ranges = wheeled(office).scan()
    quarter = len(ranges) // 4
    assert ranges[0] == pytest.approx(1 - 0.05, abs=0.03)
    assert ranges[quarter] == pytest.approx(0.9 - 0.05, abs=0.03)
    assert ranges[3 * quarter] == pytest.approx(0.9 - 0.05, abs=0.03)
    assert math.isinf(ranges[2 * quarter])


def test_the_same_seed_makes_the_same_world() -> None:
    """Two runs end in the same pose with the same scan and odometry; another seed has other noise."""

    def end(seed: int) -> tuple[object, ...]:
        with World("office", seed=seed) as world:
            drive(world, 3, Command(forward=0.4, turn=0.2))
            return world.robot.pose, wheeled(world).odometry, wheeled(world).scan()

    assert end(1) == end(1)
    assert end(1) != end(2)


def test_the_camera_shows_tags_where_they_are(office: World) -> None:
    """Tag 7 is at the end of the corridor; its distance is measured from the picture."""
    drive(office, 8, Command(forward=0.8))
    robot = wheeled(office)
    (seen,) = find_tags(robot.picture(), robot.camera.matrix, TAG_SIZE)
    assert seen.id == 7
    assert seen.position[2] == pytest.approx(11.93 - robot.pose.x - RADIUS, rel=0.1)
    assert abs(seen.position[0]) < 0.1


def test_the_drone_takes_off_and_lands(field: World) -> None:
    """It hovers at 1.2 m and lands at its start."""
    craft = drone(field)
    craft.take_off()
    drive(field, 5)
    assert state(craft) is State.HOVERING
    assert craft.altitude == pytest.approx(1.2, abs=0.1)
    craft.land()
    drive(field, 6)
    assert state(craft) is State.LANDED
    assert craft.pose.distance(2, 2) < 0.1


def test_the_drone_flies_at_a_velocity_and_holds_its_place(field: World) -> None:
    """It flies as far as its speed, also sideways, and hovers when the command ends."""
    craft = drone(field)
    craft.take_off()
    drive(field, 4)
    drive(field, 3, Command(forward=0.8, left=0.4))
    assert state(craft) is State.FLYING
    assert craft.pose.x == pytest.approx(2 + 3 * 0.8, abs=0.5)
    assert craft.pose.y == pytest.approx(2 + 3 * 0.4, abs=0.3)
    drive(field, 3)
    place = craft.pose
    drive(field, 3)
    assert state(craft) is State.HOVERING
    assert craft.pose.distance(place.x, place.y) < 0.1


def test_an_emergency_lets_the_drone_fall(field: World) -> None:
    """The rotors stop at once; the drone flies again only after a second reset."""
    craft = drone(field)
    craft.take_off()
    drive(field, 4)
    craft.reset()
    drive(field, 1)
    assert state(craft) is State.EMERGENCY
    assert craft.altitude < 0.1
    craft.take_off()
    drive(field, 1)
    assert state(craft) is State.EMERGENCY
    craft.reset()
    craft.take_off()
    drive(field, 3)
    assert craft.altitude > 1


def test_the_drone_sees_the_tag_below(field: World) -> None:
    """Hovering above the base it finds tag 10 in the picture of its downward camera."""
    craft = drone(field)
    craft.take_off()
    drive(field, 4)
    (seen,) = find_tags(craft.picture(down=True), craft.camera.matrix, TAG_SIZE)
    assert seen.id == 10
    assert seen.position[2] == pytest.approx(craft.altitude, abs=0.2)


def test_visits_are_rooms_that_the_robot_stayed_in(office: World) -> None:
    """A room counts after a second."""
    drive(office, 0.5)
    assert office.visited == []
    drive(office, 1)
    assert office.visited == ["corridor"]
