"""Tests of workers that crash, hang, or raise."""

from __future__ import annotations

import os
import signal
import time
from dataclasses import dataclass

import pytest
from patience import patient

from kg.pipeline import pool
from kg.pipeline.pool import Pool, Task
from kg.pipeline.recording import RecordingWorkspace
from kg.pipeline.report import PackageResult
from kg.pipeline.work import Job, Outcome

TASKS = [Task("local/x", f"p{number}", f"p{number}") for number in range(9)]


def _work(_job: Job, source: str, path: str, _earlier: str) -> Outcome:
    """Behave according to the number of the package."""
    if path == "p3":
        os.kill(os.getpid(), signal.SIGKILL)
    if path == "p4":
        raise ValueError("a defect")
    if path == "p5":
        time.sleep(3600)
    return Outcome(PackageResult(source, path, path, {}, {}), {}, {}, path.encode())


@pytest.mark.parametrize("jobs", [1, 3])
def test_one_package_costs_itself_only(monkeypatch: pytest.MonkeyPatch, jobs: int) -> None:
    """A package that kills its worker, raises, or never finishes is reported by name; all others are read."""
    monkeypatch.setattr(pool, "work", _work)
    job = Job(RecordingWorkspace([]), "https://example.org/", 1)
    seconds = patient(0.5)  # time for a worker to start and read the packages before, on a busy machine
    with Pool(job, TASKS, jobs, deadline=seconds) as workers:
        outcomes = {outcome.result.path: outcome for outcome in workers.outcomes()}
    assert set(outcomes) == {task.path for task in TASKS}
    messages = {
        path: outcome.result.problems[0].message for path, outcome in outcomes.items() if outcome.result.problems
    }
    assert messages == {
        "p3": "the process that read the package ended with signal SIGKILL",
        "p4": "ValueError: a defect",
        "p5": f"the package took longer than {seconds:g} s and was left out",
    }
    assert {outcome.result.problems[0].code for outcome in outcomes.values() if outcome.result.problems} == {"KG121"}
    assert not any(outcomes[path].reusable for path in messages)


@pytest.mark.parametrize("jobs", [1, 3])
def test_a_worker_with_too_much_memory_makes_way_for_a_spare_one(monkeypatch: pytest.MonkeyPatch, jobs: int) -> None:
    """No package is lost or read twice, whether there are spare workers or not."""
    monkeypatch.setattr(pool, "work", _identified)
    assert len(_processes(jobs)) <= jobs
    monkeypatch.setattr(pool, "_MOST_MEMORY", -1)
    assert len(_processes(jobs)) <= jobs
    monkeypatch.setattr(pool, "_PACKAGES", 2)
    assert len(_processes(jobs)) > jobs


def test_a_spare_worker_takes_the_place_of_one_that_died(monkeypatch: pytest.MonkeyPatch) -> None:
    """A worker that dies after it got an heir leaves its packages to it."""
    monkeypatch.setattr(pool, "work", _work)
    monkeypatch.setattr(pool, "_MOST_MEMORY", -1)
    monkeypatch.setattr(pool, "_PACKAGES", 1)
    tasks = [*TASKS[:5], *TASKS[6:]]
    with Pool(Job(RecordingWorkspace([]), "https://example.org/", 1), tasks, 2) as workers:
        outcomes = [outcome.result.path for outcome in workers.outcomes()]
    assert sorted(outcomes) == [task.path for task in tasks]


def _processes(jobs: int) -> set[bytes]:
    """Return the identities of the processes that read the packages."""
    with Pool(Job(RecordingWorkspace([]), "https://example.org/", 1), TASKS, jobs) as workers:
        outcomes = list(workers.outcomes())
    assert sorted(outcome.result.path for outcome in outcomes) == [task.path for task in TASKS]
    return {outcome.packed for outcome in outcomes}


def _identified(_job: Job, source: str, path: str, _earlier: str) -> Outcome:
    """Return the identity of the process that reads the package."""
    return Outcome(PackageResult(source, path, path, {}, {}), {}, {}, str(os.getpid()).encode())


def test_the_end_of_the_with_statement_ends_the_workers(monkeypatch: pytest.MonkeyPatch) -> None:
    """If the reader of the outcomes stops, all workers exit, even busy ones."""
    monkeypatch.setattr(pool, "work", _work)
    job = Job(RecordingWorkspace([]), "https://example.org/", 1)
    before = _children()
    with Pool(job, [TASKS[0], *[TASKS[5]] * 4], 3) as workers:
        next(workers.outcomes())
        children = _children() - before
        assert children
    assert not _children() & children


def _children() -> set[int]:
    with open(f"/proc/self/task/{os.getpid()}/children") as file:  # noqa: PTH123 - no file in the sense of a path
        return {int(number) for number in file.read().split()}


@dataclass(frozen=True)
class _Doubled:
    """A part of other work: twice its number, or the end of the worker."""

    number: int

    def run(self, shared: int) -> int:
        """Return the product with what all parts share."""
        if self.number == _DEADLY:
            os.kill(os.getpid(), signal.SIGKILL)
        return self.number * shared


_DEADLY = 4


@pytest.mark.parametrize("spares", [1, 100])
def test_workers_do_other_parts_when_all_packages_are_read(monkeypatch: pytest.MonkeyPatch, spares: int) -> None:
    """Each part has its result, and none if its worker died."""
    monkeypatch.setattr(pool, "work", _identified)
    monkeypatch.setattr(pool, "_PACKAGES", spares)
    with Pool(Job(RecordingWorkspace([]), "https://example.org/", 1), TASKS, 3) as workers:
        assert len(list(workers.outcomes())) == len(TASKS)
        found = dict(workers.answers(2, [_Doubled(number) for number in range(9)]))
    assert found == {number: None if number == _DEADLY else 2 * number for number in range(9)}


def test_parts_without_workers_have_no_result(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where all workers die, all parts are answered all the same."""
    monkeypatch.setattr(pool, "work", _identified)
    with Pool(Job(RecordingWorkspace([]), "https://example.org/", 1), TASKS, 1) as workers:
        assert len(list(workers.outcomes())) == len(TASKS)
        assert dict(workers.answers(2, [_Doubled(_DEADLY), _Doubled(1)])) == {0: None, 1: None}
