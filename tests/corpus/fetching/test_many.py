"""Tests of fetching, from repositories on this machine and from a faulty server."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest
from corpus.repositories import MANIFESTS, Behaviour, commit_tree, git, plumb, repository, served
from patience import patient

from kg.corpus.fetching import many
from kg.corpus.fetching.git import Limits
from kg.corpus.fetching.lock import Entry, read_lock, write_lock
from kg.corpus.fetching.many import Fetched, fetch, pinned
from kg.corpus.fetching.one import Options
from kg.corpus.fetching.wanted import wanted_among
from kg.errors import SourceError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

QUICK = Options(jobs=2, limits=Limits(bytes=1 << 20, seconds=60, retries=2, pause=0.01))
ROS1, ROS2 = ({"package.xml": MANIFESTS[version]} for version in ("1", "2"))


class Quiet:
    """Records the progress."""

    def __init__(self) -> None:
        self.entries: list[Entry] = []

    def begin(self, repositories: int) -> None:
        """Ignore the start."""

    def ended(self, entry: Entry) -> None:
        """Record the end."""
        self.entries.append(entry)


def run(into: Path, *addresses: str, options: Options = QUICK) -> dict[str, Entry]:
    """Fetch addresses and return the entries by the last part of their name."""
    done = fetch(wanted_among(addresses), into, into / "lock.toml", options, Quiet())
    return _by_name(done)


def _by_name(done: Fetched) -> dict[str, Entry]:
    return {entry.name.rpartition("/")[2]: entry for entry in done.entries}


@pytest.fixture
def server(tmp_path: Path) -> Iterator[tuple[str, Behaviour]]:
    """A server of the repositories below `srv`."""
    (tmp_path / "srv").mkdir()
    with served(tmp_path / "srv") as found:
        yield found


def test_files_of_one_commit(tmp_path: Path) -> None:
    """A checkout has the files of the newest commit and no history; the lock file pins it; nothing else remains."""
    source = repository(tmp_path / "srv" / "robot", {"main": {**ROS1, "src/a.cpp": "int a;"}})
    entry = run(tmp_path / "into", source.as_uri())["robot"]
    place = tmp_path / "into" / "local" / "robot"
    assert (place / "src" / "a.cpp").read_text() == "int a;"
    assert entry.commit == git(place, "rev-parse", "HEAD") == git(source, "rev-parse", "main")
    assert (entry.branch, entry.ros, entry.state, entry.folder) == ("main", "1", "fetched", "local/robot")
    assert entry.bytes > 0
    assert git(place, "config", "remote.origin.url") == source.as_uri()
    assert sorted(path.name for path in (tmp_path / "into").iterdir()) == ["local", "lock.toml"]


def test_the_lock_is_fetched_again(tmp_path: Path) -> None:
    """Elsewhere the lock file gives the same commits although the branches moved; --update uses the new ones."""
    source = repository(tmp_path / "srv" / "robot", {"main": {**ROS1, "a": "old"}})
    old = run(tmp_path / "one", source.as_uri())["robot"].commit
    git(source, "update-ref", "refs/heads/main", commit_tree(source, {**ROS1, "a": "new"}))
    for folder in ("one", "two"):
        lock = tmp_path / folder / "lock.toml"
        write_lock(lock, read_lock(tmp_path / "one" / "lock.toml").entries)
        done = fetch(pinned(lock), tmp_path / folder, lock, QUICK, Quiet())
        assert [entry.commit for entry in done.entries] == [old]
        assert (tmp_path / folder / "local" / "robot" / "a").read_text() == "old"
    text = (tmp_path / "two" / "lock.toml").read_text()
    assert text == (tmp_path / "one" / "lock.toml").read_text()
    new = run(tmp_path / "two", source.as_uri(), options=replace(QUICK, update=True))["robot"].commit
    assert new == git(source, "rev-parse", "main") != old
    assert (tmp_path / "two" / "local" / "robot" / "a").read_text() == "new"


def test_what_is_there_is_not_fetched(server: tuple[str, Behaviour], tmp_path: Path) -> None:
    """A checkout at its pinned commit needs no request; without a lock file only the branches are listed."""
    url, behaviour = server
    repository(tmp_path / "srv" / "robot", {"main": ROS1})
    run(tmp_path / "into", f"{url}/robot")
    behaviour.requests.clear()
    assert run(tmp_path / "into", f"{url}/robot")["robot"].state == "fetched"
    assert behaviour.requests == []
    (tmp_path / "into" / "lock.toml").unlink()
    assert run(tmp_path / "into", f"{url}/robot")["robot"].state == "fetched"
    assert len(behaviour.requests) <= 2


def test_a_damaged_checkout_stops_nobody_else(tmp_path: Path) -> None:
    """A checkout at the commit with missing objects is reported as in the way; others are fetched."""
    files = {**ROS1, "src/a.cpp": "a"}
    sources = [repository(tmp_path / "src" / name, {"main": files}) for name in ("robot", "other")]
    robot = sources[0].as_uri()
    place = tmp_path / "into" / run(tmp_path / "into", robot)["robot"].name
    (tmp_path / "into" / "lock.toml").unlink()
    tree = git(place, "rev-parse", "HEAD:src")
    for pack in list((place / ".git" / "objects" / "pack").glob("*.pack")):
        git(place, "unpack-objects", "-q", given=pack.rename(tmp_path / pack.name).read_bytes())
    (place / ".git" / "objects" / tree[:2] / tree[2:]).unlink()
    found = run(tmp_path / "into", *(source.as_uri() for source in sources))
    assert {name: entry.state for name, entry in found.items()} == {"robot": "in the way", "other": "fetched"}


def test_changes_of_the_user_stay(tmp_path: Path) -> None:
    """A checkout with changed files is reported and untouched, and so is a folder that is not a checkout."""
    source = repository(tmp_path / "srv" / "robot", {"main": {**ROS1, "a": "old"}})
    other = repository(tmp_path / "srv" / "other", {"main": ROS1})
    run(tmp_path / "into", source.as_uri())
    (tmp_path / "into" / "local" / "robot" / "a").write_text("mine")
    (tmp_path / "into" / "local" / "other").mkdir()
    git(source, "update-ref", "refs/heads/main", commit_tree(source, {**ROS1, "a": "new"}))
    found = run(tmp_path / "into", source.as_uri(), other.as_uri(), options=replace(QUICK, update=True))
    assert {entry.state for entry in found.values()} == {"in the way"}
    assert (tmp_path / "into" / "local" / "robot" / "a").read_text() == "mine"


@pytest.mark.parametrize(("ros", "branch"), [("1", "noetic-devel"), ("2", "main"), ("any", "main")])
def test_branch_of_a_version(ros: str, branch: str, tmp_path: Path) -> None:
    """The branch for the requested version is used."""
    source = repository(tmp_path / "srv" / "robot", {"main": ROS2, "noetic-devel": ROS1, "humble-old": ROS2})
    assert run(tmp_path / "into", source.as_uri(), options=replace(QUICK, ros=ros))["robot"].branch == branch


def test_manifests_have_the_last_word(tmp_path: Path) -> None:
    """A branch whose manifests are for the other version is replaced by the next; without any, it is reported."""
    moved = repository(tmp_path / "srv" / "moved", {"main": ROS2, "master": ROS1})
    only = repository(tmp_path / "srv" / "only", {"main": ROS2})
    found = run(tmp_path / "into", moved.as_uri(), only.as_uri(), options=replace(QUICK, ros="1"))
    assert found["moved"].branch == "master"
    assert (found["only"].state, found["only"].reason) == ("other ros", "no branch is for ROS 1; main is not")
    assert not (tmp_path / "into" / "local" / "only").exists()


def test_servers_that_misbehave(server: tuple[str, Behaviour], tmp_path: Path) -> None:
    """Missing, moved, intermittent and permanent failures are distinguished, and none stops the others."""
    url, behaviour = server
    for name in ("good", "flaky", "down"):
        repository(tmp_path / "srv" / name, {"main": ROS1})
    behaviour.moved["old"] = f"{url}/good"
    behaviour.moved["file"] = f"file://{tmp_path}/srv/good"
    behaviour.failures |= {"flaky": 2, "down": 99}
    names = ("good", "old", "file", "flaky", "down", "gone")
    found = run(tmp_path / "into", *(f"{url}/{name}" for name in names), options=replace(QUICK, jobs=4))
    assert {name: found[name].state for name in names} == {
        "good": "fetched",
        "old": "fetched",
        "file": "refused",
        "flaky": "fetched",
        "down": "unreachable",
        "gone": "gone",
    }
    assert found["old"].moved == f"{url}/good"
    assert sum("/down/" in path for path in behaviour.requests) == 3
    assert sum("/gone/" in path for path in behaviour.requests) == 1


def test_time_is_bounded(server: tuple[str, Behaviour], tmp_path: Path) -> None:
    """A server that does not respond times out, without another attempt, and leaves nothing."""
    url, behaviour = server
    behaviour.hanging.add("hanging")
    limits = replace(QUICK.limits, seconds=patient(0.5))
    found = run(tmp_path / "into", f"{url}/hanging", options=replace(QUICK, limits=limits))["hanging"]
    assert (found.state, found.reason) == ("too slow", f"it did not arrive within {limits.seconds:g} s")
    assert len(behaviour.requests) == 1
    assert [path.name for path in (tmp_path / "into").iterdir()] == ["lock.toml"]


def test_size_is_bounded(tmp_path: Path) -> None:
    """A repository too large in transfer or unpacked is aborted, and nothing of it remains."""
    noise = os.urandom(1_500_000).hex()
    coming = repository(tmp_path / "srv" / "coming", {"main": {"noise": noise}})
    unpacked = repository(tmp_path / "srv" / "unpacked", {"main": {"zeros": "0" * 3_000_000}})
    bomb = repository(tmp_path / "srv" / "bomb", {"main": {"a": "x"}})
    tree = bytes.fromhex(git(bomb, "rev-parse", "main^{tree}"))
    for _ in range(12):
        entries = b"".join(b"40000 %d\0" % number + tree for number in range(10))
        plumb(bomb, entries)
        tree = bytes.fromhex(git(bomb, "rev-parse", "main^{tree}"))
    found = run(tmp_path / "into", *(one.as_uri() for one in (coming, unpacked, bomb)))
    assert {entry.state for entry in found.values()} == {"too large"}
    assert [path.name for path in (tmp_path / "into").iterdir()] == ["lock.toml"]


@pytest.mark.parametrize("name", [b"..", b".git", b".GIT", b"a/../../b"])
def test_trees_that_lead_out(name: bytes, tmp_path: Path) -> None:
    """A tree with a path that git itself would never write is rejected."""
    source = repository(tmp_path / "srv" / "evil", {"main": ROS1})
    plumb(source, b"100644 " + name + b"\0" + bytes.fromhex(git(source, "rev-parse", "main:package.xml")))
    assert run(tmp_path / "into", source.as_uri())["evil"].state == "refused"
    assert not (tmp_path / "into" / "local").exists()


@pytest.mark.parametrize("field", ["url = -u./x", "path = -x", "url = ext::touch {ran}\n path = ../x"])
def test_submodules_that_are_options(field: str, tmp_path: Path) -> None:
    """Submodules whose address or path is an option, or leads outside, make git fail or are not fetched."""
    ran = tmp_path / "ran"
    modules = f'[submodule "x"]\n path = x\n url = https://h/x\n {field.format(ran=ran)}\n'
    source = repository(tmp_path / "srv" / "evil", {"main": {".gitmodules": modules, **ROS1}})
    found = run(tmp_path / "into", source.as_uri(), options=replace(QUICK, submodules=True))["evil"]
    assert found.state == "refused" or ("ext" in field and found.state == "fetched")
    assert not ran.exists()


def test_links_that_lead_out_are_left_out(tmp_path: Path) -> None:
    """Links out of the checkout, or into .git, are omitted; inner ones are created; git sees no change."""
    links = {"out": "->/etc/passwd", "up": "->../../x", "git": "->.git/config", "in": "->package.xml"}
    source = repository(tmp_path / "srv" / "robot", {"main": {**ROS1, **links}})
    entry = run(tmp_path / "into", source.as_uri())["robot"]
    place = tmp_path / "into" / "local" / "robot"
    assert sorted(path.name for path in place.iterdir()) == [".git", "in", "package.xml"]
    assert entry.reason == "left out 3 links that lead out, as git"
    assert git(place, "status", "--porcelain") == ""


def test_nothing_of_a_repository_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither filters nor hooks of the user's templates run, and submodules are fetched only on request."""
    trace = tmp_path / "trace"
    (tmp_path / "templates" / "hooks").mkdir(parents=True)
    hook = tmp_path / "templates" / "hooks" / "post-checkout"
    hook.write_text(f"#!/bin/sh\ntouch {trace}\n")
    hook.chmod(0o755)
    (tmp_path / "gitconfig").write_text(
        f'[init]\n templateDir = {tmp_path}/templates\n[filter "lfs"]\n smudge = touch {trace}\n required = true\n'
    )
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "gitconfig").rename(tmp_path / ".gitconfig")
    inner = repository(tmp_path / "srv" / "inner", {"main": {"in": "in"}})
    outer = repository(tmp_path / "srv" / "outer", {"main": ROS1})
    modules = f'[submodule "s"]\n path = s\n url = {inner.as_uri()}\n'
    files = {".gitmodules": modules, ".gitattributes": "* filter=lfs\n", "package.xml": MANIFESTS["1"]}
    lines = [
        f"100644 blob {git(outer, 'hash-object', '-w', '--stdin', given=text.encode())}\t{path}\n"
        for path, text in files.items()
    ]
    lines.append(f"160000 commit {git(inner, 'rev-parse', 'main')}\ts\n")
    tree = git(outer, "mktree", "--missing", given="".join(lines).encode())
    git(outer, "update-ref", "refs/heads/main", git(outer, "commit-tree", "-m", "x", tree))
    assert run(tmp_path / "plain", outer.as_uri())["outer"].state == "fetched"
    assert not any((tmp_path / "plain" / "local" / "outer" / "s").iterdir())
    found = run(tmp_path / "deep", outer.as_uri(), options=replace(QUICK, submodules=True))["outer"]
    assert (found.state, found.reason) == ("fetched", "")
    assert (tmp_path / "deep" / "local" / "outer" / "s" / "in").read_text() == "in"
    assert not trace.exists()


def test_names_in_a_lock_file_are_checked(tmp_path: Path) -> None:
    """A foreign lock file cannot name a folder other than that of the address, or another kind of address."""
    lock = tmp_path / "into" / "lock.toml"
    source = repository(tmp_path / "srv" / "robot", {"main": ROS1}).as_uri()
    write_lock(lock, [Entry("../../out", source), Entry("local/x", "ext::sh", commit="a" * 40)])
    done = fetch(pinned(lock), tmp_path / "into", lock, QUICK, Quiet())
    assert {entry.state for entry in done.entries} == {"refused"}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["into", "srv"]


def test_a_commit_that_is_gone(tmp_path: Path) -> None:
    """A pinned commit missing on the server is reported, and remains pinned."""
    source = repository(tmp_path / "srv" / "robot", {"main": ROS1}).as_uri()
    lock = tmp_path / "lock.toml"
    write_lock(lock, [Entry("local/robot", source, commit="a" * 40, branch="main")])
    (entry,) = fetch(pinned(lock), tmp_path / "into", lock, QUICK, Quiet()).entries
    assert (entry.state, entry.commit, entry.folder) == ("gone", "a" * 40, "into/local/robot")


def test_one_process_at_a_time(tmp_path: Path) -> None:
    """A second process that fetches into the same folder is rejected."""
    with many._workspace(tmp_path), pytest.raises(SourceError) as caught, many._workspace(tmp_path):
        raise AssertionError
    assert caught.value.code == "KG138"


def test_leftovers_are_removed(tmp_path: Path) -> None:
    """Leftovers of a killed run are not taken for a checkout, and are removed."""
    (tmp_path / "into" / ".fetching" / "0" / "tree").mkdir(parents=True)
    source = repository(tmp_path / "srv" / "robot", {"main": ROS1})
    assert run(tmp_path / "into", source.as_uri())["robot"].state == "fetched"
    assert not (tmp_path / "into" / ".fetching").exists()


def test_ctrl_c(server: tuple[str, Behaviour], tmp_path: Path) -> None:
    """Ctrl-C ends git and the command; finished checkouts are pinned, unfinished ones leave nothing."""
    url, behaviour = server
    repository(tmp_path / "srv" / "robot", {"main": ROS1})
    behaviour.hanging |= {"slow", "slower"}
    (tmp_path / "list").write_text("".join(f"{url}/{name}\n" for name in ("robot", "slow", "slower")))
    command = (sys.executable, "-m", "kg", "corpus", "fetch", "list", "--into", "into", "--json")
    process = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    lock = tmp_path / "into" / "corpus.lock.toml"
    deadline = time.monotonic() + patient(30)
    while not lock.exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=patient(30))
    assert (process.returncode, out) == (130, b"")
    assert [entry.name for entry in read_lock(lock).entries if entry.commit] == ["127.0.0.1/robot"]
    assert sorted(path.name for path in (tmp_path / "into").iterdir()) == ["127.0.0.1", "corpus.lock.toml"]
    assert [path.name for path in (tmp_path / "into" / "127.0.0.1").iterdir()] == ["robot"]


def test_many_at_a_time(tmp_path: Path) -> None:
    """More repositories than concurrent fetches are all fetched, each reported once."""
    sources = [repository(tmp_path / "srv" / f"r{number}", {"main": ROS1}).as_uri() for number in range(8)]
    told = Quiet()
    done = fetch(wanted_among(sources), tmp_path / "into", tmp_path / "lock", replace(QUICK, jobs=3), told)
    assert len(done.entries) == len(told.entries) == len(done.lock.entries) == 8
    assert not done.failed
    assert json.dumps([entry.name for entry in done.lock.entries]) == json.dumps([f"local/r{n}" for n in range(8)])
