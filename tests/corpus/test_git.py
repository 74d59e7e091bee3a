from __future__ import annotations

import subprocess
from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.corpus import git
from kg.corpus.git import describe, repository_name

if TYPE_CHECKING:
    from pathlib import Path

NAMES = st.from_regex(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,12}[A-Za-z0-9_]", fullmatch=True).filter(
    lambda n: not n.endswith(".git")
)


def run(folder: Path, *arguments: str) -> str:
    """Run git in a folder, with a name to commit under, and return its output."""
    command = ("git", "-C", str(folder), "-c", "user.name=A", "-c", "user.email=a@example.org", *arguments)
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A repository with one commit on `main` and a remote."""
    folder = tmp_path / "robot"
    folder.mkdir()
    run(folder, "init", "--quiet", "--initial-branch=main")
    run(folder, "remote", "add", "origin", "https://user:secret@github.com/Acme/robot.git")
    (folder / "file").write_text("one\n")
    run(folder, "add", ".")
    run(folder, "commit", "--quiet", "--message", "x")
    return folder


@given(NAMES, NAMES, st.sampled_from(["", ".git", ".git/", "/"]))
def test_every_spelling_of_an_address(owner: str, name: str, end: str) -> None:
    """All spellings of one remote give one name."""
    for start in ("https://github.com/", "https://token@github.com/", "ssh://git@github.com:22/", "git://GitHub.com/"):
        assert repository_name(f"{start}{owner}/{name}{end}") == f"github.com/{owner}/{name}"
    assert repository_name(f"git@github.com:{owner}/{name}{end}") == f"github.com/{owner}/{name}"


@pytest.mark.parametrize(
    "address", ["/home/me/robot", "../robot", "file:///srv/robot.git", "", "C:", "https://github.com/"]
)
def test_addresses_of_this_machine(address: str) -> None:
    """A remote on this machine, or none, gives no repository name."""
    assert repository_name(address) is None


@given(st.text(max_size=60))
def test_any_text_as_address(address: str) -> None:
    """Any remote gives a name or none; a name never leaves its host."""
    name = repository_name(address)
    assert name is None or not {"", ".", ".."} & set(name.split("/")[1:])


def test_checkout_is_described(checkout: Path) -> None:
    """Name, commit, branch and remote are included; the remote's password is not."""
    found = describe(checkout)
    assert found.name == "github.com/Acme/robot"
    assert found.commit == run(checkout, "rev-parse", "HEAD")
    assert (found.branch, found.dirty) == ("main", False)
    assert found.remote == "https://github.com/Acme/robot.git"


def test_changes_are_seen(checkout: Path) -> None:
    """A changed file makes a checkout dirty."""
    (checkout / "file").write_text("two\n")
    assert describe(checkout).dirty


def test_detached_head_has_no_branch(checkout: Path) -> None:
    """A detached checkout has a commit and no branch."""
    run(checkout, "checkout", "--quiet", "--detach")
    assert describe(checkout).branch is None


def test_repository_without_commit(tmp_path: Path) -> None:
    """A new repository has no commit."""
    run(tmp_path, "init", "--quiet")
    assert describe(tmp_path).commit is None


def test_plain_folder(tmp_path: Path) -> None:
    """A folder without git is a local source."""
    found = describe(tmp_path)
    assert (found.name, found.commit, found.remote) == (f"local/{tmp_path.name}", None, None)


def test_folder_ignored_by_the_checkout_around_it(checkout: Path) -> None:
    """A folder inside a checkout, but not committed there, is a local source."""
    (checkout / "scratch").mkdir()
    assert describe(checkout / "scratch").name == "local/scratch"


@pytest.mark.parametrize("packed", [False, True])
def test_without_git(checkout: Path, monkeypatch: pytest.MonkeyPatch, packed: bool) -> None:  # noqa: FBT001  (a case)
    """Without git the files in `.git` give the same state, packed or not."""
    expected = describe(checkout)
    if packed:
        run(checkout, "pack-refs", "--all")
    monkeypatch.setattr(git, "run_git", _no_git)
    assert describe(checkout) == expected


def test_worktree_without_git(checkout: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A worktree, whose `.git` is a file, is supported without git, too."""
    run(checkout, "worktree", "add", "--quiet", "-b", "side", str(tmp_path / "tree"))
    expected = describe(tmp_path / "tree")
    monkeypatch.setattr(git, "run_git", _no_git)
    assert describe(tmp_path / "tree") == expected
    assert expected.branch == "side"


@pytest.mark.parametrize(
    "setting",
    [
        "core.fsmonitor",
        "core.hooksPath",
        "filter.evil.clean",
        "filter.evil.process",
        "core.sshCommand",
        "diff.external",
    ],
)
def test_settings_of_a_repository_run_nothing(checkout: Path, tmp_path: Path, setting: str) -> None:
    """Reading the state of a repository runs no program named by its settings."""
    trace = tmp_path / "trace"
    program = tmp_path / "post-index-change"
    program.write_text(f"#!/bin/sh\ntouch {trace}\ncat\n")
    program.chmod(0o755)
    (checkout / ".gitattributes").write_text("* filter=evil\n")
    run(checkout, "config", setting, str(tmp_path if setting == "core.hooksPath" else program))
    (checkout / "file").write_text("new\n")
    assert describe(checkout).dirty
    assert not trace.exists()


def test_partial_clone_fetches_nothing(checkout: Path, tmp_path: Path) -> None:
    """A clone with missing objects does not fetch them, so programs in its settings for that do not run."""
    trace = tmp_path / "trace"
    program = tmp_path / "ssh"
    program.write_text(f"#!/bin/sh\ntouch {trace}\n")
    program.chmod(0o755)
    for key, value in {
        "core.repositoryFormatVersion": "1",
        "extensions.partialClone": "origin",
        "remote.origin.promisor": "true",
        "remote.origin.url": "ssh://git@example.org/a/b",
        "core.sshCommand": str(program),
    }.items():
        run(checkout, "config", key, value)
    tree = run(checkout, "rev-parse", "HEAD^{tree}")
    (checkout / ".git" / "objects" / tree[:2] / tree[2:]).unlink()
    (checkout / "folder").mkdir()
    describe(checkout / "folder")
    describe(checkout)
    assert not trace.exists()


def _no_git(*_: object, **__: object) -> str:
    raise FileNotFoundError("git")
