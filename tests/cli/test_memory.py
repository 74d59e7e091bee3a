"""A memory limit ends commands with a code, and leaves the store unchanged."""

from __future__ import annotations

import resource
import shutil
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from patience import patient
from repository import ROOT
from workspaces import example

from kg.cli.supervising import is_out_of_memory
from kg.store.layout import Layout

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="memory is measured on Linux alone")

ROVER = str(ROOT / "examples" / "workspace" / "rover")


def kg(*words: str, address_space: int | None = None) -> tuple[int, str]:
    """Run a command in a process of its own, with `ulimit -v` if bytes are given."""

    def limit() -> None:
        if address_space:
            resource.setrlimit(resource.RLIMIT_AS, (address_space, address_space))

    done = subprocess.run(
        [sys.executable, "-m", "kg", *words],
        capture_output=True,
        text=True,
        check=False,
        timeout=patient(120),
        preexec_fn=limit,
    )
    return done.returncode, done.stdout + done.stderr


@pytest.fixture
def store(tmp_path_factory: pytest.TempPathFactory, tmp_path: Path) -> Path:
    """A store of its own with the example workspace."""
    return shutil.copytree(example(tmp_path_factory) / ".kg", tmp_path / "store")


@pytest.mark.parametrize("command", [("build", ROVER), ("rules", "run", "--full")])
def test_the_setting_ends_a_command_with_its_code(store: Path, command: tuple[str, ...]) -> None:
    """The command fails with KG004 and its exit code; the generation is unchanged, and the next command works."""
    before = Layout(store).current()
    code, words = kg("--store", str(store), *command, "--memory", "20M")
    assert code == 6, words
    assert "KG004" in words
    assert Layout(store).current() == before
    assert kg("--store", str(store), "query", "ASK {}") == (0, "true\n")


@pytest.mark.parametrize(
    ("command", "megabytes"),
    [
        *((("build", ROVER), megabytes) for megabytes in (60, 200, 400, 600, 800)),
        (("stats",), 400),
        *((("query", "ASK {}"), megabytes) for megabytes in (60, 200)),
    ],
)
def test_little_address_space_ends_a_command_with_its_code(
    store: Path, command: tuple[str, ...], megabytes: int
) -> None:
    """If allocations fail, in Python, C++ or Rust, a command that cannot finish ends with KG004.

    The C library ends the process itself where there is no memory for what a new thread needs.
    """
    before = Layout(store).current()
    code, words = kg("--store", str(store), *command, address_space=megabytes << 20)
    ended = code == 127 and "cannot allocate memory for thread-local data" in words
    assert code == 0 or ended or (code == 6 and "KG004" in words), words
    assert code == 0 or Layout(store).current() == before


def test_below_the_limit_a_command_ends_as_without_one(tmp_path: Path) -> None:
    """Below the limit, exit code and output of the command are unchanged."""
    store = ("--store", str(tmp_path / "store"))
    code, words = kg(*store, "build", str(tmp_path / "nowhere"), "--memory", "4G")
    assert (code, words) == kg(*store, "build", str(tmp_path / "nowhere"))
    assert code == 3
    assert kg(*store, "build", ROVER, "--memory", "4G")[0] == 0


@pytest.mark.parametrize("limit", [0, 1 << 30])
def test_a_failure_without_a_reason_counts_under_a_limit_alone(monkeypatch: pytest.MonkeyPatch, limit: int) -> None:
    """C extensions may end a call without an exception after a failed allocation; only a limit makes that KG004."""
    monkeypatch.setattr("kg.cli.supervising.address_space", lambda: limit)
    error = ImportError("cannot import")
    error.__cause__ = SystemError("error return without exception set")
    assert is_out_of_memory(error) is bool(limit)
