from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import pytest
from cli.program import Program

from kg.resources import folder

if TYPE_CHECKING:
    from collections.abc import Iterator

    from cli.program import Run

ARM_SERVER: Final = "ws/rover/rover_robot/src/arm_server.cpp"
_INTERRUPTED_AT_BIRTH: Final = """
import os, signal, time
fork = os.fork

def interrupted():
    here, there = os.pipe()
    number = fork()
    if number:
        os.read(here, 1)
        os.kill(number, signal.SIGINT)
    else:
        os.write(there, b"1")
        time.sleep(1)
    return number

os.fork = interrupted
from kg.cli.main import run
run()
"""
"""Runs `kg` such that each forked process gets Ctrl-C as soon as it exists."""


@contextmanager
def started(folder: Path, *arguments: str, **options: Any) -> Iterator[subprocess.Popen[str]]:
    """Yield a running `kg` with readable standard error; it ends with the test."""
    command = [sys.executable, "-m", "kg", *arguments]
    process = subprocess.Popen(command, cwd=folder, stderr=subprocess.PIPE, text=True, **options)
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    """Return a copy of the example workspace."""
    return Path(shutil.copytree(folder("examples") / "workspace", tmp_path / "ws"))


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Run]:
    """A folder with a copy of the example workspace, `ws`, and its store, and the result of that build."""
    place = tmp_path_factory.mktemp("first") / "place"
    shutil.copytree(folder("examples") / "workspace", place / "ws")
    run = Program(place)("build", "ws")
    shutil.copytree(place, place.with_name("kept"))
    return place, run


@pytest.fixture
def built(first: tuple[Path, Run]) -> Program:
    """The program in the folder of the first build, as that build left it; a store has absolute paths of sources."""
    place, _ = first
    shutil.rmtree(place)
    shutil.copytree(place.with_name("kept"), place)
    return Program(place)


def test_a_build_tells_what_it_read_and_found(first: tuple[Path, Run]) -> None:
    """Messages go to standard error: one line a package, then the sums and the location of the store."""
    _, run = first
    assert (run.code, run.out) == (0, "")
    assert "source local/ws: 5 packages" in run.err
    assert "read rover_robot: 6 nodes, " in run.err
    assert "read 5 packages of 1 source in " in run.err
    assert " names unresolved:" in run.err
    assert run.err.endswith("store .kg\n")


def test_a_second_build_says_that_nothing_changed(built: Program) -> None:
    """Without names, a build reads the previous sources, and of them only the changes."""
    assert "nothing changed in 5 packages of 1 source" in built("build").err
    source = built.folder / ARM_SERVER
    source.write_text(source.read_text() + "\n// changed\n")
    assert "1 package" in built("status").out
    assert "read 1 package of 1 source, 4 unchanged in " in built("build").err


def test_a_node_that_reached_a_limit_is_marked(built: Program) -> None:
    """The source counts the node, and the node shows its limit and the place; the rest is built."""
    before = json.loads(built("status", "--json").out)["counts"]
    source = built.folder / ARM_SERVER
    text = source.read_text()
    call = 'ros::NodeHandle().advertise<std_msgs::Bool>("ready", 1);'
    loop = f"  for (int turn = 0; turn < 1000; ++turn) {{\n    {call}\n  }}\n"
    source.write_text(text.replace("  ros::spin(", f"{loop}  ros::spin(", 1))
    built("build")
    after = json.loads(built("status", "--json").out)["counts"]
    assert (before["bounded"], after["bounded"]) == (0, 1)
    assert "by the limit of turns at " in built("node", "arm_server").out
    (bound,) = json.loads(built("node", "arm_server", "--json").out)["bounds"]
    assert (bound["limit"], bound["file"]) == ("turns", "rover/rover_robot/src/arm_server.cpp")


def test_the_report_is_data_when_asked_for(kg: Program, workspace: Path) -> None:
    """`--json` writes the report to standard output."""
    report = json.loads(kg("build", str(workspace), "--json").out)
    assert report["counts"]["packages"] == report["read"] == 5
    assert report["counts"]["unresolved"] == sum(report["unresolved"].values())
    assert report["sources"][0]["name"] == "local/ws"


def test_problems_are_listed_by_file_as_one_can_open_it(kg: Program, workspace: Path) -> None:
    """Ten problems are shown with the rest counted; `--problems` shows all; the exit code is 0."""
    for number in range(12):
        (workspace / "rover" / "rover_core" / "msg" / f"Bad{number}.msg").write_text("int32 = = =\n")
    run = kg("build", "ws")
    assert run.code == 0
    assert "problems 12 in 12 files; the rest was built:" in run.err
    assert "  ws/rover/rover_core/msg/Bad0.msg:1: KG118 " in run.err
    assert "  and 2 more (`kg build --problems` lists all)" in run.err
    assert run.err.count("KG118") == 10
    assert kg("build", "--problems").err.count("KG118") == 12


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["build", "gone"], 3, "error[KG101]"),
        (["build", "."], 3, "error[KG102]"),
        (["build"], 4, "error[KG301]"),
        (["build", "--jobs", "none", "."], 2, "error[KG002]: --jobs is 'none'"),
    ],
)
def test_what_cannot_be_built_ends_with_its_code(kg: Program, arguments: list[str], code: int, words: str) -> None:
    """A missing folder, one without packages, no store and a bad option have different codes."""
    run = kg(*arguments)
    assert run.code == code
    assert words in run.err
    assert "\nhelp: " in run.err


def test_packages_behind_a_marker_are_named(kg: Program) -> None:
    """If markers exclude all packages, the advice names the folders."""
    (kg.folder / "src" / "arm").mkdir(parents=True)
    (kg.folder / "src" / "arm" / "COLCON_IGNORE").touch()
    assert "\nhelp: arm: COLCON_IGNORE excludes this folder;" in kg("build", "src").err


def test_status_tells_a_source_that_is_gone(built: Program) -> None:
    """A built source that no longer exists is reported as missing."""
    shutil.rmtree(built.folder / "ws")
    assert "no longer exists" in built("status").out
    assert json.loads(built("status", "--json").out)["changed"] is None


def test_the_store_named_by_the_environment_is_used(kg: Program, workspace: Path, tmp_path: Path) -> None:
    """KG_STORE names the store for builds and queries."""
    kg("build", str(workspace), KG_STORE="elsewhere")
    assert (tmp_path / "elsewhere" / "current").is_file()
    assert "base_controller" in kg("nodes", KG_STORE="elsewhere").out


def test_a_dry_run_shows_volumes_and_reads_nothing(kg: Program, workspace: Path, tmp_path: Path) -> None:
    """Packages, files and bytes of code are counted, the duration is estimated, and no store is created."""
    run = kg("build", str(workspace), "--dry-run", "--json")
    (volume,) = [json.loads(line) for line in run.out.splitlines()]
    assert (volume["packages"], volume["reused"]) == (5, 0)
    assert volume["code_bytes"] > 0
    assert volume["reading_seconds"] > 0
    assert "would read 5 packages" in run.err
    assert not (tmp_path / ".kg").exists()


def test_a_dry_run_counts_what_is_as_it_was(built: Program) -> None:
    """Unchanged packages of the last build are not counted again."""
    (volume,) = [json.loads(line) for line in built("build", "--dry-run", "--json").out.splitlines()]
    assert (volume["packages"], volume["reused"], volume["code_bytes"]) == (0, 5, 0)


def test_ctrl_c_ends_a_build_in_one_line_and_leaves_the_store(built: Program) -> None:
    """An interrupted build reports that in one line, exits with 130, and leaves the store unchanged."""
    for path in (built.folder / "ws").rglob("*.cpp"):
        path.write_text(path.read_text() + "\n// changed\n")
    with started(built.folder, "build", start_new_session=True) as process:
        assert process.stderr is not None
        assert process.stderr.readline().startswith("source ")
        os.killpg(process.pid, signal.SIGINT)
        words = process.stderr.read()
        assert process.wait() == 130
    assert "Traceback" not in words
    assert words.endswith("interrupted\n")
    assert words.count("interrupted") == 1
    assert built("build").code == 0
    assert "nothing changed" in built("build").err
    assert "base_controller" in built("nodes").out


def test_ctrl_c_as_a_worker_is_born_is_none_of_its_business(kg: Program, workspace: Path) -> None:
    """A worker interrupted before running its own code does not stop the build."""
    run = kg.python("-c", _INTERRUPTED_AT_BIRTH, "build", str(workspace))
    assert run.code == 0, run.err
    assert "interrupted" not in run.err
    assert "read 5 packages of 1 source in " in run.err


def test_watching_builds_again_when_a_file_changes(built: Program) -> None:
    """`--watch` waits for a change, reads it, and exits quietly on Ctrl-C."""
    with started(built.folder, "build", "ws", "--watch") as process:
        assert process.stderr is not None
        lines = iter(process.stderr.readline, "")
        assert any("watching" in line for line in lines)
        source = built.folder / ARM_SERVER
        # Atomically: a file being written is one change when empty, and another when complete.
        changed = built.folder / "arm_server.cpp"
        changed.write_text(source.read_text() + "\n// changed\n")
        changed.replace(source)
        assert any(line.startswith("read rover_robot: ") for line in lines)
        assert any(line.startswith("store ") for line in lines)
        process.send_signal(signal.SIGINT)
        assert process.stderr.read().strip() == ""
        assert process.wait() == 0
