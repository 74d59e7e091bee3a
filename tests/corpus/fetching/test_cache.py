"""The cache of pinned checkouts holds complete ones only, each for one address and commit."""

from __future__ import annotations

import shutil
import threading
from errno import ENOSPC
from os import strerror
from typing import TYPE_CHECKING, Any

import pytest
from corpus.repositories import MANIFESTS, commit_tree, git, repository

from kg.corpus.fetching import cache
from kg.corpus.fetching.cache import checkout, fetch_source
from kg.corpus.fetching.git import Limits
from kg.corpus.fetching.one import fetch_one
from kg.corpus.files import Pin

if TYPE_CHECKING:
    from pathlib import Path

    from kg.corpus.fetching.lock import Entry

FILES = {"package.xml": MANIFESTS["2"], "src/node.cpp": "int main() {}\n"}


def pinned(origin: Path) -> Pin:
    """Return the pin of the newest commit of a repository."""
    return Pin(f"local/{origin.name}", f"file://{origin}", git(origin, "rev-parse", "main"))


@pytest.fixture
def pin(tmp_path: Path) -> Pin:
    """A repository with one package."""
    return pinned(repository(tmp_path / "origins" / "robot", {"main": FILES}))


def test_a_second_request_fetches_nothing(pin: Pin, tmp_path: Path) -> None:
    """A checkout serves also when its origin is gone."""
    checkout(pin, "robot", tmp_path / "cache")
    shutil.rmtree(tmp_path / "origins")
    entry, folder = checkout(pin, "robot", tmp_path / "cache")
    assert (entry.state, (folder / "src" / "node.cpp").read_text()) == ("fetched", "int main() {}\n")


def test_another_address_is_another_checkout(pin: Pin, tmp_path: Path) -> None:
    """The remote of a source is the address of its pin, also for a copy with the same commits."""
    shutil.copytree(tmp_path / "origins", tmp_path / "copies")
    other = Pin(pin.name, f"file://{tmp_path}/copies/robot", pin.commit)
    found = [fetch_source(one, tmp_path / "robot", tmp_path / "cache")[1] for one in (pin, other)]
    assert [source.repository.remote for source in found if source] == [pin.url, other.url]


def test_another_commit_leaves_the_first(pin: Pin, tmp_path: Path) -> None:
    """A build at an older commit is not disturbed by one at a newer commit."""
    origin = tmp_path / "origins" / "robot"
    _, before = checkout(pin, "robot", tmp_path / "cache")
    git(origin, "update-ref", "refs/heads/main", commit_tree(origin, {**FILES, "src/node.cpp": "// newer\n"}))
    _, after = checkout(pinned(origin), "robot", tmp_path / "cache")
    texts = [(folder / "src" / "node.cpp").read_text() for folder in (before, after)]
    assert texts == ["int main() {}\n", "// newer\n"]


def test_a_source_is_as_in_its_folder(pin: Pin, tmp_path: Path) -> None:
    """Name and root are those of the folder in the lock file; times depend on the commit only."""
    root = tmp_path / "elsewhere" / "robot"
    first, second = (fetch_source(pin, root, tmp_path / name)[1] for name in ("one", "two"))
    assert first == second
    assert first is not None
    assert (first.repository.name, first.repository.root, first.root, first.pin) == (
        "local/robot",
        str(root),
        root,
        pin,
    )


def test_what_a_killed_process_left_is_removed(pin: Pin, tmp_path: Path) -> None:
    """The remains of an unfinished checkout do not stay in the cache."""
    _, folder = checkout(pin, "robot", tmp_path / "cache")
    shutil.rmtree(folder)
    (folder.parent / ".fetching-killed" / "tree").mkdir(parents=True)
    checkout(pin, "robot", tmp_path / "cache")
    assert sorted(one.name for one in folder.parent.iterdir()) == [".lock", "robot"]


def test_requests_at_once_fetch_once(pin: Pin, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A second request waits for the checkout of the first."""
    running: list[int] = []
    most: list[int] = []

    def counted(*arguments: Any) -> Entry:
        running.append(1)
        most.append(len(running))
        try:
            return fetch_one(*arguments)
        finally:
            running.pop()

    monkeypatch.setattr("kg.corpus.fetching.cache.fetch_one", counted)
    threads = [threading.Thread(target=checkout, args=(pin, "robot", tmp_path / "cache")) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert most == [1, 1, 1]


@pytest.mark.parametrize(
    ("name", "url", "folder"),
    [("local/robot", "ext::sh -c x", "robot"), ("local/../..", None, "robot"), ("local/robot", None, "..")],
    ids=["address", "name", "folder"],
)
def test_entries_that_lead_elsewhere_are_refused(
    pin: Pin, tmp_path: Path, name: str, url: str | None, folder: str
) -> None:
    """A lock file of a stranger runs nothing and writes nothing outside of the cache."""
    entry, _ = checkout(Pin(name, url or pin.url, pin.commit), folder, tmp_path / "cache")
    assert entry.state == "refused"
    assert not (tmp_path / "cache").exists()


def test_a_large_repository_leaves_nothing(pin: Pin, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A repository that exceeds a limit is missing in the cache, and the entry says why."""
    monkeypatch.setattr(cache, "LIMITS", Limits(bytes=10))
    entry, folder = checkout(pin, "robot", tmp_path / "cache")
    assert (entry.state, [one.name for one in folder.parent.iterdir()]) == ("too large", [".lock"])


def test_a_full_disk_leaves_nothing(pin: Pin, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An error of the system is a reason of the repository, and its checkout is missing."""

    def full(_: Path) -> str:
        raise OSError(ENOSPC, strerror(ENOSPC))

    monkeypatch.setattr("kg.corpus.fetching.one.ros_versions", full)
    entry, folder = checkout(pin, "robot", tmp_path / "cache")
    assert (entry.state, entry.reason.partition(":")[0]) == ("failed", "No space left on device")
    assert [one.name for one in folder.iterdir()] == [".lock"]
