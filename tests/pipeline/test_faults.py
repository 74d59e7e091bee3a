"""Tests of builds ended from outside: kill -9 and Ctrl-C at many moments."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from forks import start
from patience import examples, patient

if TYPE_CHECKING:
    from forks import Forked
    from pipeline.conftest import Bench

BUILD = """
import sys
from pathlib import Path
from kg.pipeline import build as module
from kg.settings import load
from kg.store.embedded import EmbeddedStore
module.version = lambda *_: sys.argv[3]
store = EmbeddedStore.create(Path(sys.argv[1]))
print("ready", flush=True)
module.build([sys.argv[2]], store, load({"jobs": 2}, environment={}))
sys.stdin.read()
"""


def _start(bench: Bench, version: str, *, hold: bool = False) -> Forked | subprocess.Popen[str]:
    """Fork a build that reads everything, in its own process group, and return when it begins.

    With `hold` the process runs until its standard input is closed, so a signal never reaches an interpreter that is
    already shutting down, where it kills silently.
    """
    stdin = subprocess.PIPE if hold else subprocess.DEVNULL
    process = start(
        *("-c", BUILD, str(bench.store.layout.root), str(bench.source), version),
        streams=(stdin, subprocess.PIPE, subprocess.PIPE),
        builds=True,
        session=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    return process


def _members(group: int) -> list[int]:
    """Return the running processes of a group."""
    found = []
    for folder in Path("/proc").iterdir():
        if folder.name.isdigit():
            try:
                state, _, its_group = (folder / "stat").read_text().rpartition(")")[2].split()[:3]
            except OSError:
                continue
            if int(its_group) == group and state != "Z":
                found.append(int(folder.name))
    return found


def _ended(group: int) -> bool:
    """Return whether all processes of a group exit within some time."""
    deadline = time.monotonic() + patient(20)
    while _members(group) and time.monotonic() < deadline:
        time.sleep(0.05)
    return not _members(group)


@pytest.fixture
def built(bench: Bench) -> Bench:
    """A workspace of some packages, built."""
    for number in range(12):
        bench.package(f"many{number}", f"topic{number}")
    bench.build()
    return bench


def test_kill_at_any_moment(built: Bench) -> None:
    """After kill -9 at some moments the store has its old or its new content, opens, and is writable."""
    began = time.perf_counter()
    assert _start(built, "whole").wait() == 0
    whole = time.perf_counter() - began
    before = built.content()
    generator = random.Random(7)  # noqa: S311 - moments, not secrets
    for number in range(examples(4, 12)):
        process = _start(built, f"version {number}")
        time.sleep(whole * generator.uniform(0.02, 0.9))
        process.kill()
        process.wait()
        assert built.content() == before
    assert _ended(process.pid)
    built.package("many1", "changed")
    built.build()
    assert "/changed" in built.topics()
    assert len(built.store.layout.numbers()) == 1
    assert not list(built.store.layout.root.rglob("*.tmp"))


def test_interrupt_ends_workers_and_keeps_the_store(built: Bench) -> None:
    """Ctrl-C stops the build and its workers, and leaves no generation and no temporary files."""
    before = built.content()
    for delay in (0.3, 0.6):
        process = _start(built, f"interrupted {delay}", hold=True)
        time.sleep(delay)
        os.killpg(process.pid, signal.SIGINT)
        _, errors = process.communicate(timeout=patient(20))
        assert process.returncode in {0, 130, -signal.SIGINT}
        assert process.returncode == 0 or "KeyboardInterrupt" in errors
        assert _ended(process.pid)
        assert built.content() == before
        assert len(built.store.layout.numbers()) == 1


def test_a_killed_build_does_not_keep_others_out(built: Bench) -> None:
    """The lock of a killed build is free at once, even while its workers still exit."""
    process = _start(built, "killed")
    time.sleep(0.4)
    process.kill()
    process.wait()
    assert built.build().read in {0, 15}
