"""Tests of the lock of the writer and of generations held by readers."""

from __future__ import annotations

import fcntl
import os
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace

import pytest

from kg.errors import StoreError
from kg.store import locks
from kg.store.layout import Layout, create
from kg.store.locks import busy, hold_generation, remove_unused, writer


def test_busy_tells_who_writes(tmp_path: Path) -> None:
    """Without writing, a process can get the error about the current writer, or None."""
    layout = create(tmp_path / ".kg")
    assert busy(layout) is None
    with writer(layout, "kg build x"):
        holder = busy(layout)
        assert holder is not None
        assert f"process {os.getpid()} (`kg build x`)" in holder.message
    assert busy(layout) is None


def test_readers_are_told_to_wait_for_the_first_build(tmp_path: Path) -> None:
    """Before the first generation the error names the process that writes it, if there is one."""
    layout = create(tmp_path / ".kg")
    with writer(layout, "kg build x"), pytest.raises(StoreError) as caught:
        hold_generation(layout)
    assert caught.value.hint == f"Wait for process {os.getpid()} (`kg build x`), which is building it."
    with pytest.raises(StoreError) as caught:
        hold_generation(layout)
    assert caught.value.hint == "Run `kg build FOLDER` or `kg demo` first."


def test_a_writer_that_says_nothing_yet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A lock held without a record in it still means a busy store."""
    monkeypatch.setattr(locks, "_PATIENCE", 0.05)
    layout = create(tmp_path / ".kg")
    with writer(layout, "x"):
        layout.lock.write_text("")
        with pytest.raises(StoreError) as caught, writer(layout, "y"):
            pass
    assert caught.value.code == "KG302"


@pytest.mark.parametrize("left", ["", '{"pid": %d, "command": "kg build", "since": "then"}', "[]"])
def test_who_only_looks_keeps_no_writer_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, left: str) -> None:
    """A lock without a live owner on record is released soon, and a writer waits for it."""
    layout = create(tmp_path / ".kg")
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    layout.lock.write_text(left.replace("%d", str(ended.pid)))
    looking = layout.lock.open()
    fcntl.flock(looking, fcntl.LOCK_SH)
    clock = SimpleNamespace(monotonic=time.monotonic, sleep=lambda _: looking.close())
    monkeypatch.setattr(locks, "time", clock)
    with writer(layout, "kg build x"):
        assert looking.closed
        assert busy(layout) is not None


@pytest.mark.parametrize("raised", [False, True])
def test_a_copy_of_the_lock_keeps_no_writer_out(tmp_path: Path, raised: bool) -> None:  # noqa: FBT001 - a case of the table
    """If a forked process holds a copy of the lock, it is still released when the writer ends."""
    layout = create(tmp_path / ".kg")
    copy = -1
    with suppress(ZeroDivisionError), writer(layout, "first"):
        (handle,) = (int(link.name) for link in Path("/proc/self/fd").iterdir() if _leads(link, layout.lock))
        copy = os.dup(handle)
        if raised:
            raise ZeroDivisionError
    assert busy(layout) is None
    os.close(copy)


def _leads(link: Path, file: Path) -> bool:
    try:
        return link.readlink() == file
    except OSError:
        return False


def test_the_generation_goes_while_it_is_being_held(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """If its generation is deleted at that moment, a reader takes the new one."""
    layout = create(tmp_path / ".kg")
    layout.generation(1).mkdir()
    layout.switch(1)
    current = Layout.current
    calls: list[int | None] = []

    def replaced_meanwhile(asked: Layout) -> int | None:
        number = current(asked)
        calls.append(number)
        if len(calls) == 1:
            layout.generation(2).mkdir()
            layout.switch(2)
            layout.generation(1).rmdir()
        return number

    monkeypatch.setattr(Layout, "current", replaced_meanwhile)
    number, handle = hold_generation(layout)
    os.close(handle)
    assert number == 2


def test_held_generations_stay(tmp_path: Path) -> None:
    """A held generation is not deleted until it is released; temporary files are."""
    layout = create(tmp_path / ".kg")
    layout.generation(1).mkdir()
    layout.switch(1)
    _, handle = hold_generation(layout)
    layout.generation(2).mkdir()
    layout.switch(2)
    (layout.root / "current.7.tmp").touch()
    remove_unused(layout)
    assert layout.numbers() == [1, 2]
    os.close(handle)
    remove_unused(layout)
    assert layout.numbers() == [2]
    assert not list(layout.root.glob("*.tmp"))
