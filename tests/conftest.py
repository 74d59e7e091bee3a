"""Rules for all tests: a missing program skips them, and a busy machine does not fail them."""

from __future__ import annotations

import gc
import os
import signal
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Final

import pytest
from _pytest.unraisableexception import gc_collect_iterations_key
from hypothesis import HealthCheck, settings

if TYPE_CHECKING:
    from collections.abc import Generator

PROGRAMS: Final = {"git", "java"}
_MEMORY: Final = Path("/dev/shm")  # noqa: S108 - tempfile makes the folders in it
"""In-memory file system of Linux."""
_MEMORY_BYTES: Final = 4 << 30
"""Free space that a run may need; containers often have 64 MB."""

ONE_THREAD: Final = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
"""Read by linear algebra libraries when they are loaded, here and in the processes started by tests.

With their threads a process that a build forks takes four times as long, and workers of pytest-xdist take turns anyway.
"""
QUICK_JAVA: Final = "-XX:+UseSerialGC -XX:TieredStopAtLevel=1"
"""Options of Java for short programs: with the defaults, the reasoner takes twice as long."""
_MANY: Final = 1000
"""Number of tests from which a run includes dozens that build workspaces."""

_LONGEST: Final = {"test_docs.py", "test_faults.py", "test_hostile_launches.py", "test_ontology.py"}
"""Files with tests of ten seconds: at the end of a run, one worker would run them while the others are idle."""

settings.register_profile("patient", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("patient")


def _use_memory() -> None:
    """Create temporary files in memory: a store writes through to the disk, which takes longer than the tested work."""
    if "TMPDIR" in os.environ or not os.access(_MEMORY, os.W_OK):
        return
    system = os.statvfs(_MEMORY)
    if system.f_bavail * system.f_frsize >= _MEMORY_BYTES and not system.f_flag & os.ST_NOEXEC:
        os.environ["TMPDIR"] = tempfile.tempdir = str(_MEMORY)


def _keep_bytecode() -> None:
    """Write bytecode next to the sources: otherwise hundreds of processes started by tests compile `kg` again.

    Containers often set the variable.
    """
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    sys.dont_write_bytecode = False


_use_memory()
_keep_bytecode()
gc.set_threshold(100_000)  # as kg.cli.main does
os.environ.update(ONE_THREAD)
os.environ.setdefault("JDK_JAVA_OPTIONS", QUICK_JAVA)

# What is ignored here, as under nohup or in a background job, would be ignored by the programs that tests start and
# signal; what has a handler is as usual there.
for _number in (signal.SIGHUP, signal.SIGINT, signal.SIGTERM):
    if signal.getsignal(_number) is signal.SIG_IGN:
        signal.signal(_number, lambda *_: None)


def pytest_configure(config: pytest.Config) -> None:
    """Collect garbage once at the end, not five times: a worker that has run thousands of tests has much to visit."""
    config.stash[gc_collect_iterations_key] = 1


def pytest_xdist_auto_num_workers() -> int:
    """Use four workers for two processors: tests wait for browsers, servers and clocks for a quarter of their time."""
    processors = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return max(processors + 2, processors * 3 // 2)


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Collect the tests with the garbage collector disabled, then exempt their objects from later collections.

    These objects live until the end. Otherwise forks would copy them, and each collection would visit them.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests that open pages in a browser, and begin with the longest tests."""
    items.sort(key=lambda item: item.path.name not in _LONGEST)
    for item in items:
        if "browser" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.browser)


@pytest.fixture(scope="session", autouse=True)
def _prepared(request: pytest.FixtureRequest) -> None:
    """Load the package readers once in large runs; otherwise each process forked by a build loads them."""
    if len(request.session.items) > _MANY:
        from workspaces import prepare_builds  # noqa: PLC0415 - other runs do without it

        prepare_builds()


def _skipping() -> Generator[None, object, object]:
    try:
        return (yield)
    except FileNotFoundError as error:
        if error.filename in PROGRAMS:
            pytest.skip(f"{error.filename} is not installed")
        raise


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup() -> Generator[None, object, object]:
    """Skip a test whose fixtures need a missing program."""
    return (yield from _skipping())


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call() -> Generator[None, object, object]:
    """Skip a test that needs a missing program."""
    return (yield from _skipping())
