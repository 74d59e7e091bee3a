from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING

import pytest
from cli.rover import build
from cli.test_terminal import on_terminal

from kg.cli.commands.search import row
from kg.cli.completion import features
from kg.search.documents import Document, PackageDocument
from kg.search.searching import Hit

if TYPE_CHECKING:
    from cli.program import Program


@pytest.fixture
def rover(kg: Program) -> Program:
    """Return the program with the store of the rover."""
    build(kg.folder / ".kg")
    return kg


def test_hits_are_tab_separated_off_a_terminal(rover: Program) -> None:
    """A header and a line for each hit, with the reasons; the interpretation goes to standard error."""
    run = rover("search", "plan", "the", "way", "for", "ROS", "1")
    assert run.code == 0
    head, first, *_ = run.out.splitlines()
    assert head.split("\t") == ["rank", "score", "package", "node", "why", "also in", "file:line"]
    assert first.split("\t")[3] == "planner"
    assert "only nodes with: ROS 1" in run.err


def test_hits_have_their_reasons_below_them_on_a_terminal(rover: Program) -> None:
    """Every hit has a header, then reasons, each with its line of code; a place is never broken."""
    shown = on_terminal(rover.folder, "search", "planner", NO_COLOR="1").replace("\r\n", "\n")
    head, *reasons = [line.strip() for line in shown[shown.index("1. ") :].split("\n\n")[0].splitlines()]
    assert head.startswith("1. nav/planner")
    assert any(re.search(r"[.](py|cpp|h|hpp):\d+$", line) for line in reasons)


def test_a_search_needs_words_or_filters(rover: Program) -> None:
    """A search without words or filters is a usage error."""
    for arguments in ((), ("",), ("  ",)):
        run = rover("search", *arguments)
        assert (run.code, run.out) == (2, "")
        assert "no search words or filters given" in run.err


def test_hits_are_json_lines(rover: Program) -> None:
    """`--json` writes one object a hit, best first, with the name accepted by `kg node`."""
    run = rover("search", "planner", "--json")
    hits = [json.loads(line) for line in run.out.splitlines()]
    assert [hit["rank"] for hit in hits] == list(range(1, len(hits) + 1))
    assert rover("node", f"{hits[0]['package']}/{hits[0]['name']}").code == 0


def test_a_component_has_the_name_of_its_node() -> None:
    """Hits are named as in `kg nodes`, so that other commands accept the name: a component too, not by its class."""
    node = Document("https://example.org/1", "camera", "component", 0, 2, "camera.cpp", 7, plugin="driver::CameraNode")
    hit = Hit(1, 1.0, node, PackageDocument("https://example.org/2", "local/ws", "driver"), (), ())
    assert row(hit)[3] == "camera"


def test_nothing_found_is_said(rover: Program) -> None:
    """An empty result is not an error; the exit code reports it to scripts."""
    run = rover("search", "zygomorphic")
    assert run.code == 1
    assert "no results. Try fewer words" in run.err


def test_grammatical_words_alone_are_no_need(rover: Program) -> None:
    """A search for words that every description has asks for others."""
    run = rover("search", "the")
    assert run.code == 1
    assert run.err.endswith("no results. `the` does not describe a node. Use words for what the node does.\n")


def test_a_name_that_is_nearly_right_is_named(rover: Program) -> None:
    """An unknown word may be a misspelt name, which is suggested."""
    assert "Did you mean `planner`" in rover("search", "plannner").err


def test_where_nothing_fits_the_nearest_are_shown(rover: Program) -> None:
    """Without a full match, the nearest nodes follow, marked in JSON, and the word without a match is named."""
    run = rover("search", "RPLIDAR", "planner", "--json")
    assert run.code == 0
    assert "no description of a node mentions `RPLIDAR`" in run.err
    assert "nothing here fits; nearest are" in run.err
    assert {json.loads(line)["fits"] for line in run.out.splitlines()} == {False}
    assert "nothing here fits" not in rover("search", "planner").err


def test_a_filter_that_nothing_fulfils_is_refused(rover: Program) -> None:
    """The error has the code and the available values."""
    run = rover("search", "--publishes", "Twits")
    assert run.code == 2
    assert "KG701" in run.err


def test_values_of_filters_are_completed(rover: Program, monkeypatch: pytest.MonkeyPatch) -> None:
    """Tab completes the values of nodes, types also by their last part; without a store nothing."""
    monkeypatch.chdir(rover.folder)
    kinds = features("kind")("")
    assert kinds == sorted(kinds)
    assert kinds
    offered = features("publishes")("")
    assert {name.rpartition("/")[2] for name in offered} <= set(offered)
    monkeypatch.chdir(rover.folder.parent)
    assert features("kind")("") == []
