"""A plugin of pytest that adds the processor time of each test, and of each fixture that it sets up, to the report.

    PYTHONPATH=benchmarks/tests pytest -p processor --junitxml=report.xml

Seconds are those of the process and of all below it, in user and system mode, from the accounting of a control group.
Where no group can be made, they are those of the process and of its children that have ended.
"""

from __future__ import annotations

import os
import resource
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import pytest

if TYPE_CHECKING:
    from collections.abc import Generator

TEST: Final = "processor seconds"
FIXTURE: Final = "processor seconds of fixture "
_LEAST: Final = 0.01
"""Seconds of a fixture that is reported."""
_GROUPS: Final = Path("/sys/fs/cgroup")
_STARTED: Final = pytest.StashKey[float]()
_inner: Final[list[float]] = []
"""Seconds of the fixtures that were set up inside of each fixture that is being set up."""
_group: Final[list[Path]] = []
"""The control group of this process, if it could be made."""


def pytest_configure() -> None:
    """Put this process, and so each worker of pytest-xdist, into a control group of its own."""
    parent = _GROUPS / "cpuacct"
    group = (parent if parent.is_dir() else _GROUPS) / f"kg-tests-{os.getpid()}"
    with suppress(OSError):
        group.mkdir()
        (group / "cgroup.procs").write_text(str(os.getpid()))
        _group.append(group)


def pytest_unconfigure() -> None:
    """Leave and remove the group; it stays while a process is in it."""
    while _group:
        with suppress(OSError):
            (_group[-1].parent / "cgroup.procs").write_text(str(os.getpid()))
            _group[-1].rmdir()
        _group.pop()


def seconds() -> float:
    """Return the processor time so far."""
    if _group and (usage := _group[-1] / "cpuacct.usage").exists():
        return int(usage.read_text()) / 1e9
    if _group:
        return int((_group[-1] / "cpu.stat").read_text().split()[1]) / 1e6
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    """Note the time when a test begins."""
    item.stash[_STARTED] = seconds()
    return (yield)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> None:
    """Add the time to the last report of a test."""
    if call.when == "teardown":
        item.user_properties.append((TEST, f"{seconds() - item.stash[_STARTED]:.3f}"))


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(
    fixturedef: pytest.FixtureDef[Any], request: pytest.FixtureRequest
) -> Generator[None, object, object]:
    """Add the time that a fixture takes, without that of the fixtures that it requests."""
    started = seconds()
    _inner.append(0.0)
    try:
        return (yield)
    finally:
        whole = seconds() - started
        own = whole - _inner.pop()
        if _inner:
            _inner[-1] += whole
        item = getattr(request, "_pyfuncitem", None)
        if own >= _LEAST and item is not None:
            place = f"{fixturedef.baseid}::{fixturedef.argname} ({fixturedef.scope})"
            item.user_properties.append((FIXTURE + place, f"{own:.3f}"))
