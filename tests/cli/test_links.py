from __future__ import annotations

from typing import TYPE_CHECKING

from kg.cli.links import Links
from kg.facts import Location
from kg.graph.builds import Counts
from kg.graph.source_states import SourceState

if TYPE_CHECKING:
    from pathlib import Path


def source(name: str, root: str | None, commit: str | None) -> SourceState:
    """Return a source read from `root`."""
    return SourceState(name, None, None, commit, False, root, None, None, Counts())


def test_a_file_that_is_here_is_linked_as_a_file(tmp_path: Path) -> None:
    """The link opens the local file itself, whatever its name contains."""
    (tmp_path / "a b.cpp").touch()
    links = Links.of([source("local/ws", str(tmp_path), None)])
    address = links.to("local/ws", Location("a b.cpp", 3))
    assert address is not None
    assert address.startswith("file://")
    assert address.endswith("/a%20b.cpp")


def test_a_file_that_is_gone_is_linked_to_its_commit() -> None:
    """A missing file is linked to the page of its line on the forge."""
    links = Links.of([source("github.com/acme/rover", "/nowhere", "0123abc")])
    address = links.to("github.com/acme/rover", Location("src/a.cpp", 3))
    assert address == "https://github.com/acme/rover/blob/0123abc/src/a.cpp#L3"


def test_a_place_in_another_source_is_linked_there() -> None:
    """A base class in another repository of the build is linked there."""
    links = Links.of([source("gitlab.com/a/b", None, "1"), source("local/ws", None, None)])
    address = links.to("local/ws", Location("x.hpp", 3, "gitlab.com/a/b"))
    assert address == "https://gitlab.com/a/b/-/blob/1/x.hpp#L3"


def test_where_nothing_is_known_there_is_no_link() -> None:
    """Unknown forges, missing folders and unknown sources have no link."""
    links = Links.of([source("example.org/a/b", "/nowhere", "1"), source("local/ws", None, None)])
    for name in ("example.org/a/b", "local/ws", "unknown"):
        assert links.to(name, Location("x.hpp", 3)) is None
