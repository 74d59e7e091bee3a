"""Named places: read from files, received from simulated robots, and substituted in programs."""

from __future__ import annotations

import asyncio
import math
from typing import TYPE_CHECKING
from uuid import uuid4

import pytest
from repository import ROOT
from robot.programs.trolley import CAPABILITIES

from kg.errors import RobotError, UsageError
from kg.robot.driving import find
from kg.robot.memory import Bus
from kg.robot.programs.check import check
from kg.robot.programs.parse import parse
from kg.robot.programs.places import TOPIC, at_place, offered, placed, places_of, read_places
from kg.robot.programs.write import write

if TYPE_CHECKING:
    from pathlib import Path

FILE = """kitchen = { x = 3.2, y = 1, heading = 90 }
["meeting room"]
x = 6
y = -2.5
z = 0.5
"""


def test_a_file_of_places_is_read(tmp_path: Path) -> None:
    """Lengths are in metres, headings in degrees; unspecified values are missing."""
    (tmp_path / "places.toml").write_text(FILE, encoding="utf-8")
    found = read_places(str(tmp_path / "places.toml"))
    assert set(found) == {"kitchen", "meeting room"}
    assert write(placed(parse("log kitchen; log 'meeting room'"), found)) == (
        "log (x: 3.2 m, y: 1 m, heading: 90 deg)\nlog (x: 6 m, y: -2.5 m, z: 0.5 m)\n"
    )
    assert read_places("") == {}


@pytest.mark.parametrize("text", ["kitchen = 1", "kitchen = { x = 1 }", "[a]\nx=1\ny=1\nw=1", "x", b"\xff"])
def test_what_is_no_file_of_places(text: str | bytes, tmp_path: Path) -> None:
    """An unreadable file or an invalid place is KG003 with the syntax of places."""
    file = tmp_path / "places.toml"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(UsageError) as error:
        read_places(str(file))
    assert (error.value.code, "kitchen = {" in (error.value.hint or "")) == ("KG003", True)
    with pytest.raises(UsageError):
        read_places(str(tmp_path))


@pytest.mark.parametrize(("said", "why"), [("{ x = 1 }", "`y`"), ("{ x = nan, y = 1 }", "`nan`"), ("1", "`int`")])
def test_of_a_file_of_places_the_wrong_one_is_named(said: str, why: str) -> None:
    """The invalid one of many places is named, with the reason."""
    with pytest.raises(ValueError, match=f"^`desk`: .*{why}"):
        places_of(f"kitchen = {{ x = 3, y = 1 }}\ndesk = {said}")


def test_the_file_of_the_office_is_what_its_robot_tells() -> None:
    """The places of the examples are those of the simulated world."""
    plan = pytest.importorskip("kg.robot.simulation.plan")
    assert read_places(str(ROOT / "examples/programs/office-places.toml")) == places_of(
        plan.read_plan("office").places()
    )


def test_places_stand_for_their_names() -> None:
    """A name is replaced with its place everywhere except in paths; a variable of the program takes precedence."""
    places = places_of(FILE)
    text = "if kitchen = there then\n  go to a pose  at: kitchen within 60 s\nend\n"
    program = parse("set there to (x: 1 m, y: 1 m)\n" + text)
    wrong = ["the variable `kitchen` has no value here", "no place is called `kitchen`"]
    assert [one.message for one in check(program, CAPABILITIES)] == wrong
    assert check(placed(program, places), CAPABILITIES) == []
    assert "at: (x: 3.2 m, y: 1 m, heading: 90 deg) within 60 s" in write(placed(program, places))
    own = parse("set kitchen to (x: 1 m, y: 1 m)\nset 'meeting room' to 3\nlog kitchen")
    assert placed(own, places) == own
    assert placed(own, {}) is own


def test_a_place_that_is_misspelt_is_offered_as_it_is_called() -> None:
    """A similar known place is suggested; without one, the hint explains how to define a place."""
    places = places_of(FILE)
    for name, hint in (("kitchn", "Did you mean `kitchen`?"), ("attic", "name the robot that defines it (`--robot`)")):
        program = placed(parse(f"go to a pose  at: {name} within 60 s"), places)
        [problem] = check(program, CAPABILITIES, places)
        assert hint in (problem.hint or "")


@pytest.mark.parametrize(("told", "names"), [(FILE, {"kitchen", "meeting room"}), ("no = places", set())])
def test_a_simulated_robot_tells_its_places(told: str, names: set[str]) -> None:
    """A valid published file of places is used; invalid or missing data gives no places."""

    async def ask() -> list[set[str]]:
        with Bus(uuid4().hex) as bus:
            robot, face = bus.join("/robot"), bus.join("/face")
            before = set(await offered(face, await face.graph()))
            publication = await robot.advertise(TOPIC, "std_msgs/String", latch=True)
            await publication.publish({"data": told})
            return [before, set(await offered(face, await face.graph()))]

    assert asyncio.run(ask()) == [set(), names]


def test_a_place_stands_for_arguments() -> None:
    """A place provides arguments of a capability, in its units; explicit arguments take precedence."""
    going, places = find(CAPABILITIES, "goingToPose", "write"), places_of(FILE)
    found = at_place(going, {"at": "kitchen"}, places)
    assert found == pytest.approx({"x": 3.2, "y": 1.0, "heading": math.pi / 2})
    assert at_place(going, {"at": "meeting room", "y": "2 m"}, places) == {"x": 6.0, "y": "2 m"}
    assert at_place(going, {"x": "1"}, places) == {"x": "1"}
    for name, known, hint in (("kitchn", places, "Did you mean `kitchen`?"), ("attic", {}, "--places")):
        with pytest.raises(RobotError, match=f"no place is called `{name}`") as refused:
            at_place(going, {"at": name}, known)
        assert hint in (refused.value.hint or "")
    driving = find(CAPABILITIES, "drivingAtVelocity", "write")
    assert at_place(driving, {"at": "kitchen"}, places) == {"at": "kitchen"}
