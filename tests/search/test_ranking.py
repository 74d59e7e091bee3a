from __future__ import annotations

import msgspec
import pytest
from search.store import CONTENT

from kg.search.index import MARKS, build
from kg.search.reading import Content
from kg.search.searching import Search, covered, prior, scores
from kg.search.words import lexicon, stem

PLAIN = next(node for node in CONTENT.nodes if node.texts and node.kind == "executable")
PACKAGE = CONTENT.packages[PLAIN.package]


def worth(*asked: str, **changes: object) -> float:
    """Return the prior of the node with the most texts, after changes."""
    node = msgspec.structs.replace(PLAIN, package=0, **changes)
    return float(prior(build(Content([PACKAGE], [node])), frozenset(asked))[0])


DOWN = lexicon().weights["down"]


@pytest.mark.parametrize(
    ("changes", "cause"),
    [
        ({"name": "test_merger"}, "test"),
        ({"path": "examples/merger.cpp"}, "mark"),
        ({"path": "tests/mocks/merger.cpp"}, "test"),
        ({"name": "merger_old"}, "mark"),
        ({"texts": ()}, "untold"),
    ],
)
def test_what_is_rarely_meant_is_worth_less(changes: dict[str, object], cause: str) -> None:
    """Tests, examples and old versions by their names and folders, and nodes without a description, rank lower."""
    assert worth() == worth(path="src/test.cpp") == 1.0
    assert worth(**changes) == pytest.approx(1 - DOWN[cause])


def test_an_example_in_a_test_loses_for_both() -> None:
    """The parts that tests and examples lose are multiplied."""
    assert worth(path="tests/examples/merger.cpp") == pytest.approx((1 - DOWN["test"]) * (1 - DOWN["mark"]))


def test_what_launch_files_start_is_worth_more() -> None:
    """The more starts, the more; variants of a node count together."""
    assert worth(starts=100) > worth(starts=2) > worth(starts=0) == 1.0
    nodes = [msgspec.structs.replace(one, starts=9 * (at == 0)) for at, one in enumerate(CONTENT.nodes)]
    started = build(Content(CONTENT.packages, nodes, CONTENT.concepts)).started
    assert started[1] == started[0] > started[2] == 0


@pytest.mark.parametrize("text", ["merge the scans of two lasers", "zusammenlegen", "camera"])
def test_what_a_node_covers_is_a_share(text: str) -> None:
    """The coverage is from 0 to 1, whatever the need."""
    found = Search(build(CONTENT))
    shares = covered(found.index, found.find(text).need)
    assert ((shares >= 0) & (shares <= 1)).all()
    assert scores(found.index, found.find(text).need).max() < 2


@pytest.mark.parametrize(
    ("text", "fits"),
    [
        ("merge the scans of two lasers into one", True),
        ("RPLIDAR driver", False),
        ("driver of Robotiq grippers", False),
        ("camera driver", True),
        ("camra driver", True),
        ("subscribes LaserScan", True),
    ],
)
def test_where_nothing_fits_hits_are_only_the_nearest(text: str, fits: bool) -> None:  # noqa: FBT001 - of a table
    """A need with an unknown name fits no node; a typing error changes nothing."""
    answer = Search(build(CONTENT)).find(text)
    assert answer.fits is fits
    assert all(hit.fits is fits for hit in answer.hits)


@pytest.mark.parametrize(
    "word", ["tests", "examples", "demo", "samples", "tutorials", "mock", "simulated", "simulator"]
)
def test_words_that_mark_down_are_compared_as_stems(word: str) -> None:
    """The form of the word in a name or a folder does not matter."""
    assert stem(word) in MARKS
    assert all(stem(one) == one for one in MARKS)


def test_what_was_asked_for_is_not_marked_down() -> None:
    """A request for a test lifts its mark; other marks remain."""
    assert worth("test", name="test_merger") == 1.0
    assert worth("test", path="tests/tutorials/merger.cpp") == pytest.approx(1 - DOWN["mark"])
    assert worth("merger", name="test_merger") == pytest.approx(1 - DOWN["test"])


def test_nodes_like_others_that_fit_are_worth_more() -> None:
    """A node gains from neighbours with the same rare words; its variants are not its neighbours."""
    merger, driver = CONTENT.nodes[0], CONTENT.nodes[3]
    twin = msgspec.structs.replace(merger, iri="https://example.org/twin", name="merger_of_clouds", package=1)
    index = build(Content(CONTENT.packages, [merger, twin, driver], CONTENT.concepts))
    assert index.near[0][0] == 1
    assert index.shares.sum(axis=1).tolist() == pytest.approx([1, 1, 1])
    need = Search(index).find("merge the scans of several lasers").need
    with_neighbours = scores(index, need)
    index.shares = index.shares * 0
    assert (with_neighbours[:2] > scores(index, need)[:2]).all()
    variants = build(CONTENT)
    assert all(variants.group[place] != variants.group[0] for place in variants.near[0][variants.shares[0] > 0])
