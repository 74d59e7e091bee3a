"""Table 9: calls found by name alone, facts checked against their lines."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from graph.samples import source_triples
from hypothesis import given
from hypothesis import strategies as st
from pyoxigraph import NamedNode

from kg.evaluate.code_check import Places, Site, check_code, holds, sites, statement_end, without_words
from kg.evaluate.sheet import STATED, Fact, SourceLines
from kg.evaluate.tables import Share, weighed
from kg.facts import (
    Interface,
    Location,
    NodeKind,
    NodeType,
    Package,
    PackageFacts,
    PluginSlot,
    Repository,
    Resolution,
    Role,
)
from kg.graph.iris import Iris
from kg.graph.source_states import sources
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from evaluate.conftest import Field

CASES = Path(__file__).parent / "cases"
FACT = Fact("publishes", "r", "p", "n", "~/ns/scan", None, None, "r", "a.cpp", 2)


def test_calls_of_cpp() -> None:
    """Comments, strings, macros and declarations are not calls; a statement may span lines."""
    found = set(sites((CASES / "calls.cpp").read_text("utf-8"), "cpp"))
    assert found == {
        Site("publishes", 8, 8, 8),
        Site("subscribes", 10, 9, 11),
        Site("publishes", 12, 12, 12),
        Site("calls action", 13, 13, 13),
        Site("provides", 14, 14, 14),
        Site("serves action", 15, 15, 15),
        Site("has parameter", 16, 16, 16),
        Site("has parameter", 17, 17, 17),
    }


def test_calls_of_python() -> None:
    """Docstrings, definitions and base classes are not calls."""
    found = set(sites((CASES / "calls.py.txt").read_text("utf-8"), "python"))
    assert found == {
        Site("publishes", 5, 5, 6),
        Site("subscribes", 8, 8, 8),
        Site("calls action", 9, 9, 9),
        Site("has parameter", 10, 10, 10),
    }


@given(st.text(alphabet="ab\n\"'#/*\\R(){};.<>=, x", max_size=200), st.sampled_from(["cpp", "python"]))
def test_any_text_keeps_its_places(text: str, language: str) -> None:
    """Non-code is replaced with spaces of the same length, on the same lines; and calls lie in their statements."""
    code = without_words(text, language)
    assert len(code) == len(text)
    assert [at for at, sign in enumerate(code) if sign == "\n"] == [at for at, sign in enumerate(text) if sign == "\n"]
    call = f"\n{text}\nx.create_publisher(a, b)\n"
    assert all(site.first <= site.line <= site.last for site in sites(call, language))
    assert 0 <= statement_end(code, 0) <= len(code)


@pytest.mark.parametrize(
    ("fact", "line", "right"),
    [
        (FACT, 'pub = nh.advertise<A>("scan", 1);', True),
        (FACT, 'pub = nh.advertise<A>(\n  "scan",\n 1);', True),
        (FACT, 'pub = nh.advertise<A>(name, 1);\nother("scan");', False),
        (FACT, 'scan = nh.subscribe("scan", 1);', False),
        (replace(FACT, written="topic + name"), "pub = nh.advertise<A>(topic+name, 1);", True),
        (FACT, 'pub = ImageTransport(nh).advertise(\n  "scan", 1);', True),
        (replace(FACT, value="{}/scan"), 'pub = nh.advertise<A>(ns + "/scan", 1);', True),
        (replace(FACT, value=None), "pub = nh.advertise<A>(name, 1);", True),
        (replace(FACT, value=None, written="other"), "pub = nh.advertise<A>(name, 1);", False),
        (replace(FACT, relation="has parameter", path="a.yaml", value="gains.p"), "p: 1.0", True),
    ],
)
def test_a_line_holds_a_fact(fact: Fact, line: str, right: bool) -> None:  # noqa: FBT001 - a case
    """The statement that begins on the line needs the call, and the name's last part or the written expression."""
    assert holds(fact, ["", *line.split("\n")]) is right


def test_the_example_against_its_code(field: Field) -> None:
    """Only the pair of a statement that creates options and one that uses them is missing; failures are named."""
    with field.store.read() as snapshot:
        found = check_code(snapshot, SourceLines(sources(snapshot)), 1000, 0)
        again = check_code(snapshot, SourceLines(sources(snapshot)), 30, 7)
        assert again == check_code(snapshot, SourceLines(sources(snapshot)), 30, 7)
    shares = {(row[0], row[1]): row[2] for row in found.table.rows if isinstance(row[2], Share)}
    calls = [share for (measure, _), share in shares.items() if str(measure).startswith("calls")]
    assert sum(share.whole for share in calls) == 80
    assert sum(share.part for share in calls) == 79
    assert [(one.kind, one.address.partition("rover_robot/")[2]) for one in found.missed] == [
        ("publishes", "src/scan_filter_nodelet.cpp:34"),
        ("publishes", "src/scan_filter_nodelet.cpp:33"),
    ]


def test_files_that_changed_are_counted_apart(field: Field, tmp_path: Path) -> None:
    """A file that changed since reading, or a missing source, is not judged."""
    copy = Path(shutil.copytree(field.source, tmp_path / "field"))
    (copy / "rover" / "rover_robot" / "scripts" / "patrol").with_suffix(".py").write_text("changed = 1\n")
    node = copy / "rover" / "rover_robot" / "src" / "scan_filter_nodelet.cpp"
    node.write_text("// changed\n" + node.read_text())
    with field.store.read() as snapshot:
        lines = SourceLines(replace(one, root=str(copy)) for one in sources(snapshot))
        assert "2 files that were changed since" in check_code(snapshot, lines, 10, 0).table.notes[1]
        gone = SourceLines(replace(one, root=str(tmp_path / "none")) for one in sources(snapshot))
        absent = check_code(snapshot, gone, 10, 0).table.notes
    assert "1 sources that are not on this machine" in absent[1]
    assert "10 sampled facts" in absent[2]


def test_files_of_tests_are_searched_on_demand(field: Field, tmp_path: Path) -> None:
    """Calls of tests count on request."""
    copy = Path(shutil.copytree(field.source, tmp_path / "field"))
    folder = copy / "rover" / "rover_robot" / "test"
    folder.mkdir()
    (folder / "a.py").write_text("rospy.Publisher('x', String)\n")
    with field.store.read() as snapshot:
        lines = SourceLines(replace(one, root=str(copy)) for one in sources(snapshot))
        without, with_ = (check_code(snapshot, lines, 1000, 0, tests=tests) for tests in (False, True))
    assert "1 files of tests" in without.table.notes[1]
    assert len(with_.missed) == len(without.missed) + 1


def test_groups_are_weighed_by_their_size() -> None:
    """The mean of the shares is weighted by size, absent if a group is unchecked, and exact if all are checked."""
    found = weighed([(90, 10, 10), (10, 10, 5)])
    assert found is not None
    assert found.value == pytest.approx(0.95)
    assert found.interval == pytest.approx((0.95, 0.95))
    assert weighed([(90, 0, 0), (10, 10, 5)]) is None
    assert weighed([]) is None


def test_what_is_no_end_has_no_place(tmp_path: Path) -> None:
    """A slot for plugins read by a helper is neither end nor parameter; the publisher next to it has its call."""
    here = Location("a.cpp", 1)
    end = Interface(Role.PUBLISHES, "scan", None, Resolution.LITERAL, here, via=(Location("b.cpp", 4),))
    slot = PluginSlot(None, here, reason="it is computed", via=(Location("a.cpp", 3),))
    node = NodeType("n", NodeKind.EXECUTABLE, "cpp", 1, here, interfaces=(end,), slots=(slot,))
    facts = PackageFacts("r", Package("p", "p", 1, Location("p/package.xml", 1)), (node,))
    iris = Iris()
    store = EmbeddedStore.create(tmp_path / ".kg")
    with store.write("test") as transaction:
        triples = source_triples(Repository("r", "/r", None), [facts], iris)
        transaction.load(NamedNode(iris.source_graph("r")), [triples])
    with store.read() as snapshot:
        places = Places(snapshot)
    assert not any(places.has(relation, ("r", "a.cpp"), 3, 3) for relation in STATED)
    assert places.has("publishes", ("r", "b.cpp"), 4, 4)
