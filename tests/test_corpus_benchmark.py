"""Tests of the benchmark that builds a corpus: its checkouts and its counts."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest
from repository import ROOT

from kg.corpus.fetching.lock import read_lock, standing
from kg.corpus.fetching.wanted import wanted_among

if TYPE_CHECKING:
    from pathlib import Path

MANIFEST = "<package><name>p</name><buildtool_depend>catkin</buildtool_depend></package>"
ADDRESS = "https://github.com/owner/robot"


@pytest.fixture(scope="module", autouse=True)
def _benchmarks() -> Any:
    """Make the modules of the benchmarks importable."""
    sys.path.insert(0, str(ROOT / "benchmarks"))
    yield
    sys.path.remove(str(ROOT / "benchmarks"))


@pytest.fixture
def mirrors(tmp_path: Path) -> Path:
    """Return a folder with the git directory of one repository; one of its files exceeds the size limit."""
    folder = tmp_path / "mirrors" / "owner+robot" / "repo"
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(MANIFEST)
    (folder / "large.bag").write_bytes(b"x" * 1_000_001)
    _commit(folder, "first")
    return tmp_path / "mirrors"


def _commit(folder: Path, message: str) -> None:
    git = ["git", "-C", str(folder), "-c", "user.name=a", "-c", "user.email=a@b.c"]
    for arguments in (["init", "--quiet"], ["add", "."], ["commit", "--quiet", "-m", message]):
        subprocess.run([*git, *arguments], check=True)


def _check_out(mirrors: Path, into: Path, *addresses: str) -> Any:
    from corpus.checkouts import check_out_all  # noqa: PLC0415 - the fixture makes it importable

    return check_out_all(wanted_among(addresses), mirrors, into)


def test_a_checkout_is_at_the_commit_of_its_mirror(mirrors: Path, tmp_path: Path) -> None:
    """The lock file pins the commit, and a build reports it as unchanged although a large file is missing."""
    _check_out(mirrors, tmp_path / "corpus", ADDRESS)
    found = standing(read_lock(tmp_path / "corpus" / "corpus.lock.toml"))
    assert [(one.name, one.ros) for one in found.present] == [("github.com/owner/robot", "1")]
    assert not found.drifted
    assert not (tmp_path / "corpus" / "github.com" / "owner" / "robot" / "large.bag").exists()


def test_a_checkout_that_is_there_stays(mirrors: Path, tmp_path: Path) -> None:
    """A second run rewrites no file."""
    _check_out(mirrors, tmp_path / "corpus", ADDRESS)
    file = tmp_path / "corpus" / "github.com" / "owner" / "robot" / "package.xml"
    before = file.stat()
    _check_out(mirrors, tmp_path / "corpus", ADDRESS)
    assert file.stat().st_ino == before.st_ino


def test_a_checkout_follows_its_mirror(mirrors: Path, tmp_path: Path) -> None:
    """A mirror with a newer commit replaces the checkout."""
    _check_out(mirrors, tmp_path / "corpus", ADDRESS)
    mirror = mirrors / "owner+robot" / "repo"
    (mirror / "new.txt").write_text("new\n")
    _commit(mirror, "second")
    lock = _check_out(mirrors, tmp_path / "corpus", ADDRESS)
    assert (tmp_path / "corpus" / "github.com" / "owner" / "robot" / "new.txt").exists()
    assert not standing(lock).drifted


def test_a_repository_without_a_mirror_is_gone(mirrors: Path, tmp_path: Path) -> None:
    """A missing mirror is in the lock file with the reason, and does not stop the others."""
    lock = _check_out(mirrors, tmp_path / "corpus", ADDRESS, "https://github.com/owner/other")
    assert [(one.name, one.state) for one in lock.entries] == [
        ("github.com/owner/other", "gone"),
        ("github.com/owner/robot", "fetched"),
    ]


def test_failures_are_counted_by_kind(mirrors: Path, tmp_path: Path) -> None:
    """States of the lock file and codes of the build are counted by the place of each problem."""
    from corpus.building import failures  # noqa: PLC0415 - the fixture makes it importable

    lock = _check_out(mirrors, tmp_path / "corpus", ADDRESS, "https://github.com/owner/other")
    words = "problems 2 in 2 files; the rest was built:\n  a.py:38: KG115 part of it\n  b c.py:1: KG115 part\nKG121\n"
    assert failures(lock, words) == {"gone": 1, "KG115": 2}
