"""Tests of the addresses of places."""

from __future__ import annotations

from typing import TYPE_CHECKING
from urllib.parse import unquote, urlsplit

from hypothesis import given
from hypothesis import strategies as st

from kg.facts import Location
from kg.graph.builds import Counts
from kg.graph.source_states import SourceState
from kg.resources import folder
from kg.views.evidence import Places

if TYPE_CHECKING:
    from pathlib import Path


def source(name: str, root: str | None, commit: str | None) -> SourceState:
    """Return a source read from `root`."""
    return SourceState(name, None, None, commit, False, root, None, None, Counts())


def test_a_place_in_a_file_that_is_here(tmp_path: Path) -> None:
    """A place in a local file has the file, an address for the editor, the page of the commit, and its text."""
    (tmp_path / "a b.cpp").write_text("one\ntwo\n")
    places = Places.of([source("github.com/acme/rover", str(tmp_path), "0123abc")])
    found = places.evidence("github.com/acme/rover", Location("a b.cpp", 2))
    assert found == {
        "repository": "github.com/acme/rover",
        "commit": "0123abc",
        "path": "a b.cpp",
        "line": 2,
        "file": str(tmp_path / "a b.cpp"),
        "vscode": f"vscode://file{tmp_path}/a%20b.cpp:2",
        "web": "https://github.com/acme/rover/blob/0123abc/a%20b.cpp#L2",
    }
    assert places.code("github.com/acme/rover", Location("a b.cpp", 2)) == {"line_text": "two", "line_stored": False}


def test_a_whole_file_has_no_line() -> None:
    """Without a line, neither the page nor the place names one."""
    found = Places.of([source("github.com/a/b", None, "1")]).evidence("github.com/a/b", Location("x.launch", 0))
    assert (found["line"], found["web"]) == (None, "https://github.com/a/b/blob/1/x.launch")


def test_nothing_is_guessed() -> None:
    """Unknown sources and forges, and missing folders, give no address."""
    places = Places.of([source("example.org/a/b", "/nowhere", "1")])
    for name in ("example.org/a/b", "unknown"):
        found = places.evidence(name, Location("x.hpp", 3))
        assert [found[key] for key in ("file", "vscode", "web")] == [None, None, None]


def test_lines_outside_of_a_source_are_not_read(tmp_path: Path) -> None:
    """A path that leaves its source has no text."""
    (tmp_path / "secret").write_text("word\n")
    (tmp_path / "source").mkdir()
    places = Places.of([source("local/source", str(tmp_path / "source"), None)])
    assert places.code("local/source", Location("../secret", 1))["line_text"] is None


def stored(_repository: str, path: str) -> dict[int, str]:
    """Return the stored lines of a file."""
    return {2: "advertise(", 3: '  "odom");', 5: "login(password…"} if path == "a.cpp" else {}


def test_a_line_of_a_file_that_is_gone_is_from_the_store() -> None:
    """The statement and its end are shown, and marked as stored."""
    places = Places.of([source("local/a", "/nowhere", None)], stored)
    found = places.code("local/a", Location("a.cpp", 2), whole=True)
    assert found == {"line_text": 'advertise( "odom");', "line_stored": True}


def test_a_line_that_changed_is_shown_as_it_was_read(tmp_path: Path) -> None:
    """The text is the evidence of the fact, not the current content of the file."""
    (tmp_path / "a.cpp").write_text("// new\nsubscribe(\n")
    places = Places.of([source("local/a", str(tmp_path), None)], stored)
    assert places.code("local/a", Location("a.cpp", 2)) == {"line_text": "advertise(", "line_stored": True}


def test_a_line_that_is_as_it_was_is_from_its_file(tmp_path: Path) -> None:
    """The line is complete even if the stored snippet is shortened."""
    (tmp_path / "a.cpp").write_text('\n\n\n\nlogin(password, "x");\n')
    places = Places.of([source("local/a", str(tmp_path), None)], stored)
    found = places.code("local/a", Location("a.cpp", 5))
    assert found == {"line_text": 'login(password, "x");', "line_stored": False}


def test_rules_and_ontologies_are_named_from_where_they_stand() -> None:
    """Paths of files shipped with `kg` omit the folders above them."""
    found = Places.own(folder("ontology") / "rnkg.ttl", 3)
    assert (found["path"], found["line"]) == ("ontology/rnkg.ttl", 3)
    assert found["vscode"].endswith("/ontology/rnkg.ttl:3")


@given(st.text(min_size=1), st.text(min_size=1), st.integers(1, 10**6))
def test_pages_of_any_path_stay_on_their_forge(name: str, path: str, line: int) -> None:
    """For any name and path, the page is on its forge, and keeps its path and its line."""
    repository = f"github.com/{name}"
    web = Places.of([source(repository, None, "c")]).web(repository, Location(path, line))
    assert web is not None
    parts = urlsplit(web)
    assert (parts.scheme, parts.netloc, parts.query, parts.fragment) == ("https", "github.com", "", f"L{line}")
    assert unquote(parts.path, errors="surrogatepass") == f"/{name}/blob/c/{path}"
