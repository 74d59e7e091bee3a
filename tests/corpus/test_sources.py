from __future__ import annotations

import subprocess
from typing import TYPE_CHECKING

import pytest

from kg.corpus.sources import ListedSource, fetch_source, is_address, parse_source, read_list
from kg.errors import SourceError

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def remote(tmp_path: Path) -> Path:
    """A repository with a file that differs between `main` and the tag `v1`."""
    folder = tmp_path / "remote"
    folder.mkdir()
    for arguments in (
        ("init", "--quiet", "--initial-branch=main"),
        ("config", "uploadpack.allowAnySHA1InWant", "true"),
        ("commit", "--quiet", "--allow-empty", "--message", "one"),
        ("tag", "v1"),
    ):
        git(folder, *arguments)
    (folder / "file").write_text("two\n")
    git(folder, "add", ".")
    git(folder, "commit", "--quiet", "--message", "two")
    return folder


def git(folder: Path, *arguments: str) -> None:
    """Run git in a folder, with a name to commit under."""
    identity = ("-c", "user.name=A", "-c", "user.email=a@example.org")
    subprocess.run(("git", "-C", str(folder), *identity, *arguments), check=True, capture_output=True)


@pytest.mark.parametrize(
    ("text", "address", "ref"),
    [
        ("https://github.com/a/b.git@v1", "https://github.com/a/b.git", "v1"),
        ("https://user@host/a/b", "https://user@host/a/b", None),
        ("git@github.com:a/b.git@feature/x", "git@github.com:a/b.git", "feature/x"),
        ("ssh://git@host:22/a/b@r", "ssh://git@host:22/a/b", "r"),
        ("/folder/name@part", "/folder/name@part", None),
    ],
)
def test_addresses_with_refs(text: str, address: str, ref: str | None) -> None:
    """A ref follows the last part of an address; folders may have any name."""
    assert parse_source(text) == ListedSource(address, ref)
    assert is_address(text) is not text.startswith("/")


def test_list_of_sources(tmp_path: Path) -> None:
    """A list has addresses and folders relative to it; comments and empty lines only count as lines."""
    path = tmp_path / "sources.txt"
    path.write_text("# robots\nhttps://example.org/a/b@v1   # pinned\n\nfolder#1\n")
    assert read_list(path) == (
        ListedSource("https://example.org/a/b", "v1", 2),
        ListedSource(str(tmp_path / "folder#1"), None, 4),
    )


def test_list_that_is_not_there(tmp_path: Path) -> None:
    """An unreadable list is an error with the code of missing sources."""
    with pytest.raises(SourceError) as caught:
        read_list(tmp_path / "none")
    assert caught.value.code == "KG101"


def test_fetching(remote: Path, tmp_path: Path) -> None:
    """A repository is fetched at the requested ref, and updated in place."""
    said: list[str] = []
    target = fetch_source(remote.as_uri(), "v1", tmp_path / "cache" / "it", said.append)
    assert not (target / "file").exists()
    fetch_source(remote.as_uri(), None, target, said.append)
    assert (target / "file").read_text() == "two\n"
    assert said[0] == f"fetching {remote.as_uri()}"


@pytest.mark.parametrize(
    ("url", "ref"),
    [
        ("file:///nowhere/at/all", None),
        ("ext::sh -c touch% /tmp/x", None),
        ("ftp://example.org/a/b", None),
        ("--upload-pack=x", None),
        ("https://example.org/a/b", "--exec=x"),
        ("https://example.org/a/b", "a..b"),
        ("http://example.org/a/b", None),
        ("ssh://-oProxyCommand=x/a/b", None),
        ("git@-oProxyCommand=x:a/b", None),
        ("https://example.org/a\n/b", None),
    ],
)
def test_what_is_not_fetched(url: str, ref: str | None, tmp_path: Path) -> None:
    """Other schemes, disguised options and missing repositories are errors with an explanation."""
    with pytest.raises(SourceError) as caught:
        fetch_source(url, ref, tmp_path / "it")
    assert caught.value.code == "KG103"


def test_git_says_why(remote: Path, tmp_path: Path) -> None:
    """The error contains git's message, without a password in the address."""
    with pytest.raises(SourceError, match="couldn't find remote ref absent"):
        fetch_source(remote.as_uri(), "absent", tmp_path / "it")
    with pytest.raises(SourceError) as caught:
        fetch_source("file://me:secret@/nowhere", None, tmp_path / "it")
    assert "secret" not in str(caught.value)
