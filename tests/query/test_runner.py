"""Tests of the thread that runs a query: its result, its deadline, and its end."""

from __future__ import annotations

import itertools
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from threading import Event

import pytest
from patience import patient

from kg.query.runner import DeadlineError, in_thread

BOUNDED = """
import resource
from pathlib import Path
from kg.query.runner import in_thread

now = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (now + (600 << 20), now + (600 << 20)))
for number in range(100):
    assert in_thread(lambda: number, None) == number
"""


def test_what_it_raises_is_raised() -> None:
    """The exception of the work is raised, also one that looks like a deadline; the next work is unaffected."""
    for error in (KeyError("gone"), TimeoutError("of a socket")):

        def work(error: Exception = error) -> None:
            raise error

        with pytest.raises(type(error)) as raised:
            in_thread(work, 10)
        assert raised.value is error
    assert in_thread(lambda: 1, None) == 1


def test_a_deadline_ends_the_waiting() -> None:
    """Work that continues after its deadline is abandoned: KG503."""
    over = Event()
    with pytest.raises(DeadlineError) as raised:
        in_thread(lambda: over.wait(patient(60)), 0.05)
    over.set()
    assert raised.value.code == "KG503"


def test_nothing_is_left() -> None:
    """The thread has ended when the result is returned, and later threads have the usual stack."""
    size = threading.stack_size()
    assert not in_thread(threading.current_thread, None).is_alive()
    assert threading.stack_size() == size


def test_room_for_a_stack_is_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """The previous stack may be released late; if there is never enough address space, an error is raised."""
    start, refusals = threading.Thread.start, iter(range(3))

    def late(thread: threading.Thread) -> None:
        if next(refusals, None) is not None:
            raise RuntimeError("can't start new thread")
        start(thread)

    monkeypatch.setattr(threading.Thread, "start", late)
    assert in_thread(lambda: 1, None) == 1
    refusals = itertools.count()
    monkeypatch.setattr("kg.query.runner._ROOM_SECONDS", 0.02)
    with pytest.raises(RuntimeError, match="can't start new thread"):
        in_thread(lambda: 1, None)
    assert threading.stack_size() == 0


def test_stacks_stay_usual_when_many_begin() -> None:
    """Queries that start at the same time do not change the stacks of other threads."""
    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(lambda number: in_thread(lambda: number, None), range(400))) == list(range(400))
    assert threading.stack_size() == 0


@pytest.mark.skipif(sys.platform != "linux", reason="how large a process is is read in /proc")
def test_one_stack_at_a_time() -> None:
    """With limited address space, successive queries find space for their stacks."""
    done = subprocess.run([sys.executable, "-c", BOUNDED], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
