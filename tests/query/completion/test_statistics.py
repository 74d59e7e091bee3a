from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from pyoxigraph import Store

from kg.query.completion.keeping import Kept
from kg.query.completion.service import complete
from kg.query.completion.statistics import SAMPLE, Statistics, count
from kg.store.snapshot import MemorySnapshot
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from kg.store.snapshot import EmbeddedSnapshot

MANY = SAMPLE * 3


def snapshot_of(update: str, generation: int = 0) -> MemorySnapshot:
    """Return a snapshot of what an update makes of nothing."""
    store = Store()
    store.update(update, prefixes=dict(PREFIXES))
    found = MemorySnapshot(store)
    found.generation = generation
    return found


SMALL = """INSERT DATA {
  <urn:a> a <urn:C> ; <urn:p> 1, 2 ; <urn:q> <urn:b> . <urn:b> a <urn:D> .
  <urn:p> a rdf:Property ; rdfs:comment "longer than it" , "what it is" .
  <urn:o> sh:declare [ sh:prefix "my" ; sh:namespace "urn:my/" ] }"""


def test_counts_what_goes_together() -> None:
    """Classes, properties and their pairs are counted, and where properties lead."""
    found = count(snapshot_of(SMALL))
    assert found.classes["urn:C"] == 1
    assert found.properties["urn:p"] == 2
    assert found.used["urn:C"] == {PREFIXES["rdf"] + "type": 1, "urn:p": 1, "urn:q": 1}
    assert found.leads["urn:q"] == {"urn:D": 1}
    assert "urn:p" in found.literal
    assert "urn:q" not in found.literal
    assert found.comments == {"urn:p": "what it is"}
    assert found.prefixes == {"my": "urn:my/"}


def test_numbers_of_large_classes_are_estimates() -> None:
    """Of a class with more instances than are looked at, what all have is exact and the rest has two digits."""
    rows = " ".join(f"<urn:{n}> a <urn:C> ; <urn:all> {n} . " for n in range(MANY))
    half = " ".join(f"<urn:{n}> <urn:half> {n} . " for n in range(0, MANY, 2))
    used = count(snapshot_of(f"INSERT DATA {{ {rows} {half} <urn:0> <urn:rare> 1 }}")).used["urn:C"]
    assert used["urn:all"] == MANY
    assert used["urn:half"] == pytest.approx(MANY / 2, rel=0.3)
    assert used["urn:half"] % 10 == 0
    assert used["urn:rare"] == 1


def test_is_counted_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What was counted is read from the cache afterwards; an unreadable file is counted again."""
    snapshot = snapshot_of(SMALL)
    first = Kept(tmp_path, snapshot).statistics()
    with monkeypatch.context() as patched:
        patched.setattr("kg.query.completion.keeping.count", lambda _: pytest.fail("counted again"))
        assert Kept(tmp_path, snapshot).statistics() == first
    (file,) = tmp_path.rglob("statistics.json")
    file.write_text("{")
    assert Kept(tmp_path, snapshot).statistics() == first


def test_an_earlier_count_serves_until_it_is_fresh(tmp_path: Path) -> None:
    """After a change the old numbers serve at once; whoever asks for fresh ones counts, and the old ones go."""
    old = Kept(tmp_path, snapshot_of(SMALL, 1)).statistics()
    kept = Kept(tmp_path, snapshot_of("INSERT DATA { <urn:x> a <urn:E> }", 2))
    assert kept.statistics() == old
    assert kept.statistics(fresh=True).classes == {"urn:E": 1}
    assert kept.statistics().classes == {"urn:E": 1}
    assert {path.parent.name for path in tmp_path.rglob("statistics.json")} == {"2"}


def test_a_folder_that_cannot_be_written_is_done_without() -> None:
    """Where nothing can be kept on disk, the process keeps it."""
    kept = Kept(Path("/dev/null/cache"), snapshot_of(SMALL))
    assert kept.statistics().classes["urn:C"] == 1
    assert kept.known().classes["urn:C"] == 1


def test_nothing_is_known_before_somebody_counts() -> None:
    """Asking what is known counts nothing."""
    assert Kept(None, snapshot_of(SMALL)).known() == Statistics()


def test_the_example_workspace_has_its_classes(examples: EmbeddedSnapshot) -> None:
    """On the example workspace the numbers are those of queries."""
    found = count(examples)
    rows = examples.query("SELECT (COUNT(*) AS ?n) { ?s a rnkg:NodeType }", prefixes=PREFIXES)
    assert str(found.classes[PREFIXES["rnkg"] + "NodeType"]) == next(iter(rows))[0].value  # type: ignore[arg-type] # rows of a SELECT


def test_what_is_typed_fills_no_disk(tmp_path: Path) -> None:
    """Values are kept for what the store has, not for each name that somebody types."""
    snapshot = snapshot_of('INSERT DATA { <urn:x> a <urn:C> ; <urn:p> "apple" }', 1)
    kept = Kept(tmp_path, snapshot)
    kept.statistics(fresh=True)

    def offered(kind: str) -> list[str]:
        text = f'SELECT * {{ ?s a <{kind}> ; <urn:p> "a'
        return [item["label"] for item in complete(text, len(text), kept, list)["items"]]

    assert offered("urn:C") == ["apple"]
    files = sorted(tmp_path.rglob("*"))
    assert [offered(f"urn:unknown:{number}") for number in range(3)] == [[], [], []]
    assert sorted(tmp_path.rglob("*")) == files
