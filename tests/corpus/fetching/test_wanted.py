"""Tests of fetched addresses: those safe for git, and their folders."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.corpus.fetching.wanted import protocols, read_wanted, wanted_among
from kg.errors import SourceError

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize(
    ("address", "why"),
    [
        ("--upload-pack=touch x", "blanks"),
        ("--upload-pack=x", "an option for git"),
        ("-u./payload", "an option for git"),
        ("ext::sh", "names a program"),
        ("ext::sh -c touch% x", "blanks"),
        ("fd::17", "names a program"),
        ("https://h/a\n/b", "control characters"),
        ("ftp://h/a/b", "scheme ftp"),
        ("javascript://h/a", "scheme javascript"),
        ("robots/here", "not the address"),
        ("ssh://-oProxyCommand=x/a/b", "an option for ssh"),
        ("git@-oProxyCommand=x:a/b", "not the address"),
        ("https://h/../../etc", "leads out"),
        ("file:///srv/../x", "leads out"),
        ("https://h/a/.git", "not a valid folder name"),
        ("https://h/a/.GIT/b", "not a valid folder name"),
        ("https://h/a/-b", "not a valid folder name"),
        ("https://h/a/b%2e%2e", "not a valid folder name"),
        ("https://h/a/b@--exec=x", "is not a branch"),
        ("https://h/a/b@x..y", "is not a branch"),
    ],
)
def test_addresses_that_are_refused(address: str, why: str) -> None:
    """Options, programs, paths that lead outside and folders reserved by git are rejected before git runs."""
    (found,) = wanted_among([address])
    assert why in found.problem


@pytest.mark.parametrize(
    ("address", "name", "allowed"),
    [
        ("https://github.com/a/b.git", "github.com/a/b", "https"),
        ("https://user:secret@GitHub.com/a/b", "github.com/a/b", "https"),
        ("git@gitlab.com:group/sub/b.git", "gitlab.com/group/sub/b", "ssh"),
        ("http://127.0.0.1:80/a", "127.0.0.1/a", "http:https"),
        ("git://h/a/b", "h/a/b", "git"),
        ("file:///srv/robots/b.git", "local/b", "file"),
    ],
)
def test_addresses_that_are_fetched(address: str, name: str, allowed: str) -> None:
    """An address gives the folder of its checkout, and git may use only its own protocol."""
    (found,) = wanted_among([address])
    assert (found.name, found.problem) == (name, "")
    assert protocols(found.url) == allowed


def test_one_folder_for_each() -> None:
    """A repeated address is fetched once; nested folders, or the same ones except for case, are rejected."""
    addresses = ["https://h/a/b", "https://h/a/b.git", "https://h/A/b", "https://h/a", "https://h/a/c@v1"]
    found = {one.name: one for one in wanted_among(addresses)}
    assert list(found) == ["h/a/b", "h/A/b", "h/a", "h/a/c"]
    assert found["h/a/b"].problem == "its folder is in that of h/a"
    assert found["h/A/b"].problem == "its folder is that of h/a/b but for case"
    assert found["h/a"].problem == ""
    assert found["h/a/c"].ref == "v1"


_REPOSITORIES = ("file:///srv/b.git", "file:///opt/b", "file:///opt/c", "https://h/a/b", "git@h:a/b", "ssh://h/a/c")


@given(st.lists(st.tuples(st.sampled_from(_REPOSITORIES), st.sampled_from(("", "@v1", "@v2"))), max_size=6))
def test_no_address_is_dropped(addresses: list[tuple[str, str]]) -> None:
    """Each address with its ref is fetched into its folder, or rejected with the conflicting one."""
    found = wanted_among(url + ref for url, ref in addresses)
    fetched = {one.name: one for one in found if not one.problem}
    for url, ref in addresses:
        (own,) = wanted_among([url + ref])
        held = fetched[own.name]
        is_fetched = held.ref == own.ref and (held.url == own.url or not own.name.startswith("local/"))
        refused = [one for one in found if (one.url, one.ref) == (own.url, own.ref) and one.problem]
        assert is_fetched or held.url in refused[0].problem


@given(st.text(max_size=80))
def test_any_text_as_address(text: str) -> None:
    """Any text is accepted or rejected, and never gets a folder outside."""
    for one in wanted_among([text]):
        parts = one.name.split("/")
        assert one.problem or not {"", ".", "..", ".git"} & set(parts)


def test_list_of_repositories(tmp_path: Path) -> None:
    """A list has one address a line; comments and empty lines are ignored."""
    (tmp_path / "list").write_text("# robots\n\nhttps://h/a/b@v1 # pinned\n")
    assert [(one.url, one.ref) for one in read_wanted(tmp_path / "list")] == [("https://h/a/b", "v1")]
    with pytest.raises(SourceError) as caught:
        read_wanted(tmp_path / "none")
    assert caught.value.code == "KG101"
