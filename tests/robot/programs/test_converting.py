"""Programs as experts' code: valid Python that passes linters and runs in ROS 1."""

from __future__ import annotations

import asyncio
import subprocess
import sys
import time
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import pytest
from msgspec.structs import replace
from patience import patient
from repository import ROOT
from robot.programs.debian import SYSTEM, has_ros, ros
from robot.programs.rclpy_standin import modules
from robot.programs.trolley import CAPABILITIES

from kg.errors import RobotError
from kg.robot.capability import Capability, Parameter, Way
from kg.robot.connecting import look
from kg.robot.live import infer
from kg.robot.programs.converting import convert
from kg.robot.programs.metrics import code_metrics, foreign_types, metrics
from kg.robot.programs.parse import parse
from kg.robot.programs.places import placed, places_of
from kg.robot.simulation.plan import PLANS, read_plan
from kg.settings import load as load_settings

if TYPE_CHECKING:
    from kg.robot.capability import Capabilities

HERE = Path(__file__).parent
CASES = HERE / "cases" / "run"
SOUND = [case for case in sorted(CASES.glob("*.kgp")) if case.stem not in {"break", "spin"}]
LIBRARIES: tuple[Literal["rospy", "rclpy"], ...] = ("rospy", "rclpy")
RULES = "E4,E7,E9,F,D,I,N,UP,B"
CLASHING = "D203,D213"


@pytest.fixture(scope="module")
def converted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Convert all cases to both libraries, in a folder."""
    folder = tmp_path_factory.mktemp("converted")
    for case in SOUND:
        for to in LIBRARIES:
            code = convert(parse(case.read_text(encoding="utf-8")), CAPABILITIES, to=to)
            (folder / f"{case.stem}_{to}.py").write_text(code, encoding="utf-8")
    return folder


def test_code_passes_the_linter(converted: Path) -> None:
    """Converted programs pass ruff: errors, docstrings, order of imports, names, modern syntax, bugs."""
    lint(converted)


def lint(folder: Path) -> None:
    """Run ruff on the code in a folder."""
    command = [sys.executable, "-m", "ruff", "check", "--isolated", "--select", RULES, "--ignore", CLASHING, "."]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout


def test_examples_pass_the_linter(tmp_path: Path) -> None:
    """The code of the exercises passes, too, for their robots."""
    pytest.importorskip("pybullet", reason="robots are simulated by pybullet")
    hosting = pytest.importorskip("kg.robot.simulation.running")

    async def seen(world: str) -> Capabilities:
        async with hosting.hosted_in_memory(world) as (_, address):
            return infer(await look(address), load_settings(), address=address)

    for world in PLANS:
        capabilities, places = asyncio.run(seen(world)), places_of(read_plan(world).places())
        for file in sorted((ROOT / "examples/programs").glob(f"{world}*.kgp")):
            for to in LIBRARIES:
                code = convert(placed(parse(file.read_text(encoding="utf-8")), places), capabilities, to=to)
                (tmp_path / f"{file.stem.replace('-', '_')}_{to}.py").write_text(code, encoding="utf-8")
    lint(tmp_path)


@pytest.mark.parametrize("to", LIBRARIES)
def test_code_stays_as_it_is(to: Literal["rospy", "rclpy"]) -> None:
    """The code for each program equals the one in cases/convert."""
    text = (CASES.parent / "convert" / "patrol.kgp").read_text(encoding="utf-8")
    expected = (CASES.parent / "convert" / f"patrol_{to}.txt").read_text(encoding="utf-8")
    assert convert(parse(text), CAPABILITIES, to=to) == expected


def test_figures_are_those_of_the_code() -> None:
    """The counts are blocks and capabilities of a program, and lines, components and message types of its code."""
    program = parse((CASES / "drive.kgp").read_text(encoding="utf-8"))
    counted_blocks = metrics(program, CAPABILITIES)
    assert (counted_blocks.blocks, counted_blocks.capabilities) == (5, 4)
    counted = code_metrics(convert(program, CAPABILITIES, to="rospy"))
    assert (counted.publishers, counted.subscribers, counted.clients, counted.action_clients) == (2, 1, 0, 1)
    assert (counted.components, counted.message_types) == (4, 4)
    assert 80 < counted.lines < 120


def test_what_is_no_code_is_not_counted() -> None:
    """Comments, docstrings and blank lines are not counted as code."""
    assert code_metrics('"""Text.\n\nMore."""\n\n# comment\nx = (\n    1,\n)\n').lines == 3


def test_messages_of_ros_2_get_what_their_fields_take(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Real fields get floats and integer fields ints, even if the ontology's defaults have no point."""
    speeds = tuple(replace(one, default=0) for one in CAPABILITIES.capabilities[0].parameters)
    by_motors = Way(kind="topic", name="/pwm", type="std_msgs/Int16", node="/motors", fields={"value": "data"})
    motors = Capability(
        iri="#drivingMotors",
        name="drivingMotors",
        label="turn the motors",
        modality="write",
        parameters=(Parameter(name="value", label="value"),),
        ways=(by_motors,),
    )
    known = replace(CAPABILITIES, capabilities=(replace(CAPABILITIES.capabilities[0], parameters=speeds), motors))
    text = (
        "move at a velocity  forward: 1 m/s for 10 ms\nmove at a velocity  turn: 1 rad/s for 10 ms\n"
        "for i from 1 to 2\n  turn the motors  value: i / 2\nend\n"
    )
    for name, module in modules("geometry_msgs/Twist", "std_msgs/Int16").items():
        monkeypatch.setitem(sys.modules, name, module)
    code = convert(parse(f'program "Wheels"\n{text}'), known, to="rclpy")
    (tmp_path / "wheels.py").write_text(code, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    node = import_module("wheels").Wheels()
    monkeypatch.delitem(sys.modules, "wheels")
    node.connect()
    node.run()
    assert [(one.linear.x, one.angular.z) for one in node.published["/cmd_vel"][:1]] == [(1.0, 0.0)]
    assert [one.data for one in node.published["/pwm"]] == [0, 1]


def test_types_that_only_the_other_version_has_are_told() -> None:
    """ROS 1 goal types unknown in ROS 2 are reported; shared and unknown types are not."""
    code = "from move_base_msgs.action import MoveBase\nfrom geometry_msgs.msg import Twist\nfrom own.msg import Own\n"
    assert foreign_types(code, 2) == ["move_base_msgs/MoveBase"]
    assert foreign_types("from nav2_msgs.msg import NavigateToPoseAction\n", 1) == ["nav2_msgs/NavigateToPose"]
    assert foreign_types(convert(parse("go to a pose  x: 1 m"), CAPABILITIES, to="rospy"), 1) == []


def test_what_cannot_be_reached_is_refused() -> None:
    """A capability without ways cannot be converted."""
    with pytest.raises(RobotError, match="KG839"):
        convert(parse("fly"), CAPABILITIES)


def test_programs_with_errors_are_refused() -> None:
    """Errors of a program are reported before conversion."""
    with pytest.raises(RobotError, match="KG833"):
        convert(parse("log 1 m + 2 s"), CAPABILITIES)


@pytest.mark.ros
@pytest.mark.skipif(not has_ros(), reason="Debian's ROS 1 (rospy, rosmaster, move_base_msgs) is missing")
def test_code_runs_in_ros(tmp_path: Path) -> None:
    """A converted program drives a node of Debian's rospy, and stops it."""
    text = (CASES.parent / "convert" / "patrol.kgp").read_text(encoding="utf-8")
    program = tmp_path / "patrol.py"
    program.write_text(convert(parse(text), CAPABILITIES, to="rospy"), encoding="utf-8")
    with ros(tmp_path) as (environment, said):
        run = subprocess.run(
            [SYSTEM, str(program)],
            env=environment,
            capture_output=True,
            text=True,
            timeout=patient(30),
            check=False,
        )
        end = time.monotonic() + patient(10)
        while (told := said.read_text(encoding="utf-8").splitlines())[-1] != "speed 0" and time.monotonic() < end:
            time.sleep(0.05)  # the trolley reports a command when its turn comes
    logged = [line.rpartition(": ")[2] for line in run.stdout.splitlines() if "[INFO]" in line]
    assert run.returncode == 0, run.stderr
    assert logged == ["a wall", "over the line", "in vain", "round 1", "round 2", "arrived"], run.stdout
    assert "speed 1" in told
    assert "said hello" in told
    assert told[-1] == "speed 0"
