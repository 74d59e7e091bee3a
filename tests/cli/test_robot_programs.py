"""`kg robot run`, `check` and `convert` as users type them."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from typing import TYPE_CHECKING

import pytest
from patience import patient
from robot.programs.debian import has_ros, ros

if TYPE_CHECKING:
    from pathlib import Path

    from cli.program import Program

WRONG = """\
program "wrong"
move at a velocity  forward: 0.2 m/s for 3 m
moove at a velocity  forward: 0.2 m/s for 1 s
"""
ROUND = """\
log "off we go"
move at a velocity  forward: 0.5 m/s for 500 ms
wait until x of sensingPose > 20 m within 300 ms
"""


def saved(folder: Path, text: str, name: str = "a.kgp") -> str:
    """Write a program to a file and return its name."""
    (folder / name).write_text(text, encoding="utf-8")
    return name


def test_a_sound_program_is_told(kg: Program) -> None:
    """Without a robot, a program is checked against all known capabilities."""
    run = kg("robot", "check", saved(kg.folder, "go to a pose  x: 3 m, y: 1 m within 60 s\n"))
    assert (run.code, run.out, run.err) == (0, "", "note: the program is sound for the ontology\n")


def test_what_some_robots_lack_is_not_required(kg: Program) -> None:
    """Without a robot, only values that each message of a capability has are required."""
    run = kg("robot", "check", saved(kg.folder, "gripping opening: 8 cm within 10 s\ngo to a pose  y: 1 m\n"))
    assert run.code == 1
    assert "`go to a pose` needs its `x`" in run.err
    assert "gripping" not in run.err


def test_problems_stand_at_their_lines(kg: Program) -> None:
    """Each problem has its line with a caret, and instructions; the exit code is 1."""
    run = kg("robot", "check", saved(kg.folder, WRONG))
    assert (run.code, run.out) == (1, "")
    assert " --> a.kgp:2:42\n" in run.err
    assert "2 | move at a velocity  forward: 0.2 m/s for 3 m\n  |" in run.err
    assert "error[KG832]" in run.err
    assert "Did you mean `move at a velocity`" in run.err


def test_problems_are_objects_too(kg: Program) -> None:
    """`--json` writes an object for each problem."""
    run = kg("robot", "check", saved(kg.folder, WRONG), "--json")
    found = [json.loads(line) for line in run.out.splitlines()]
    assert run.code == 1
    assert [(one["code"], one["line"], one["path"]) for one in found] == [
        ("KG833", 2, "/body/0/seconds"),
        ("KG832", 3, "/body/1"),
    ]


@pytest.mark.parametrize("command", ["check", "run"])
def test_what_is_no_program_is_told_as_json(kg: Program, command: str) -> None:
    """Text that cannot be parsed is a JSON object on standard output, with its place and without other output."""
    run = kg("robot", command, saved(kg.folder, "log 1\nwait\n"), "--json")
    (found,) = (json.loads(line) for line in run.out.splitlines())
    assert (found["severity"], found["code"], found["path"], found["id"]) == ("error", "KG830", "", None)
    assert (found["file"], found["line"], found["column"]) == ("a.kgp", 2, 5)
    assert (run.code, run.err) == (1, "")


def test_text_that_is_no_program_is_refused(kg: Program) -> None:
    """The error names the line and suggests a word."""
    run = kg("robot", "check", saved(kg.folder, "reapeat 4 times\nend\n"))
    assert run.code == 1
    assert " --> a.kgp:1:9\n" in run.err
    assert "Did you mean `repeat`" in run.err


def test_a_program_is_a_behaviour_tree_and_back(kg: Program) -> None:
    """`--to bt` writes XML for BehaviorTree.CPP; the reverse conversion gives the same text."""
    text = 'program "fetch"\ngo to a pose  x: 300 cm, y: 1 m within 1 min\n'
    tree = kg("robot", "convert", saved(kg.folder, text), "--to", "bt")
    assert '<goingToPose x="3" y="1"/>' in tree.out
    again = kg("robot", "convert", saved(kg.folder, tree.out, "b.xml"))
    assert (again.code, again.out) == (0, text)


def test_a_behaviour_tree_is_not_run_as_it_is(kg: Program) -> None:
    """Running a tree fails with instructions to convert it."""
    run = kg("robot", "check", saved(kg.folder, "<root/>", "b.xml"))
    assert "error[KG830]" in run.err
    assert "kg robot convert b.xml > b.kgp" in run.err


def test_forms_are_converted_into_each_other(kg: Program) -> None:
    """Text converts to JSON and back to the same text."""
    text = "# round\nrepeat 4 times\n  wait 1 s\nend\n"
    run = kg("robot", "convert", saved(kg.folder, text), "--to", "json")
    assert run.code == 0
    again = kg("robot", "convert", saved(kg.folder, run.out, "b.json"))
    assert (again.code, again.out) == (0, text)


def test_what_a_program_takes_is_counted(kg: Program) -> None:
    """`--metrics` counts blocks and capabilities."""
    run = kg("robot", "convert", saved(kg.folder, ROUND), "--metrics")
    assert json.loads(run.out) == {"blocks": 3, "capabilities": 2}


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("check", "none.kgp"), "`none.kgp` cannot be read"),
        (("convert", "a.kgp", "--to", "cobol"), "unknown form `cobol` of a program"),
        (("run", "a.kgp", "--seconds", "soon"), "`--seconds soon` is not a number of seconds"),
        (("check", "a.kgp", "--robot", "x", "--launch", "y"), "--launch conflicts with --robot"),
    ],
)
def test_wrong_words_are_refused(kg: Program, arguments: tuple[str, ...], said: str) -> None:
    """Invalid combinations of options are usage errors."""
    saved(kg.folder, ROUND)
    run = kg("robot", *arguments)
    assert run.code == 2
    assert said in run.err


@pytest.mark.ros
@pytest.mark.skipif(not has_ros(), reason="Debian's ROS 1 (rospy, rosmaster, move_base_msgs) is missing")
def test_programs_run_in_ros(kg: Program) -> None:
    """A program reports its progress in ROS 1, and fails at its line; a dry run moves nothing; Ctrl-C stops it."""
    file = saved(kg.folder, ROUND)
    with ros(kg.folder) as (environment, said):
        address = environment["ROS_MASTER_URI"].replace("http", "ros1")
        dry = kg("robot", "run", file, "--robot", address, "--dry-run")
        assert "would send to topic /cmd_vel (geometry_msgs/Twist)" in dry.out
        assert "speed" not in said.read_text(encoding="utf-8")
        run = kg("robot", "run", file, "--robot", address)
        assert run.code == 1
        assert "  2: move at a velocity  forward: 0.5 m/s for 500 ms\n" in run.out
        assert "error[KG837]" in run.err
        assert " --> a.kgp:3:1\n" in run.err
        endless = saved(kg.folder, "log 1\nmove at a velocity  forward: 0.1 m/s for 1 h\n", "b.kgp")
        command = [sys.executable, "-m", "kg", "robot", "run", endless, "--robot", address]
        running = subprocess.Popen(command, cwd=kg.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        assert running.stdout is not None
        while "2: move" not in running.stdout.readline():
            assert running.poll() is None
        running.send_signal(signal.SIGINT)
        out, err = running.communicate(timeout=patient(20))
        end = time.monotonic() + patient(10)
        while (told := said.read_text(encoding="utf-8").splitlines())[-1] != "speed 0" and time.monotonic() < end:
            time.sleep(0.05)  # the trolley reports a command when its turn comes
    assert (running.returncode, err) == (130, "\ninterrupted\n")
    assert "cancelled after 2 statements" in out
    assert told[-1] == "speed 0"
