from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from pyoxigraph import Store

from kg.query.completion.service import complete
from kg.query.completion.statistics import SAMPLE, SnapshotCache, Statistics, count
from kg.store.snapshot import MemorySnapshot
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from kg.store.snapshot import EmbeddedSnapshot

MANY = SAMPLE * 3


def snapshot_of(update: str, generation: int = 0) -> MemorySnapshot:
    """Return a snapshot of an empty store after an update."""
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
    """Classes, properties and their pairs are counted, as are the classes of values."""
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
    """For a class larger than the sample, properties of all instances are exact and others have two digits."""
    rows = " ".join(f"<urn:{n}> a <urn:C> ; <urn:all> {n} . " for n in range(MANY))
    half = " ".join(f"<urn:{n}> <urn:half> {n} . " for n in range(0, MANY, 2))
    used = count(snapshot_of(f"INSERT DATA {{ {rows} {half} <urn:0> <urn:rare> 1 }}")).used["urn:C"]
    assert used["urn:all"] == MANY
    assert used["urn:half"] == pytest.approx(MANY / 2, rel=0.3)
    assert used["urn:half"] % 10 == 0
    assert used["urn:rare"] == 1


def test_is_counted_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Statistics are read from the cache afterwards; an unreadable file is replaced."""
    snapshot = snapshot_of(SMALL)
    first = SnapshotCache(tmp_path, snapshot).statistics()
    with monkeypatch.context() as patched:
        patched.setattr("kg.query.completion.statistics.count", lambda _: pytest.fail("counted again"))
        assert SnapshotCache(tmp_path, snapshot).statistics() == first
    (file,) = tmp_path.rglob("statistics.json")
    file.write_text("{")
    assert SnapshotCache(tmp_path, snapshot).statistics() == first


def test_an_earlier_count_serves_until_it_is_fresh(tmp_path: Path) -> None:
    """After a change the old numbers are returned at once; a request for fresh ones counts and deletes the old ones."""
    old = SnapshotCache(tmp_path, snapshot_of(SMALL, 1)).statistics()
    kept = SnapshotCache(tmp_path, snapshot_of("INSERT DATA { <urn:x> a <urn:E> }", 2))
    assert kept.statistics() == old
    assert kept.statistics(fresh=True).classes == {"urn:E": 1}
    assert kept.statistics().classes == {"urn:E": 1}
    assert {path.parent.name for path in tmp_path.rglob("statistics.json")} == {"2"}


def test_a_folder_that_cannot_be_written_is_done_without() -> None:
    """If the folder is not writable, the process caches the statistics."""
    kept = SnapshotCache(Path("/dev/null/cache"), snapshot_of(SMALL))
    assert kept.statistics().classes["urn:C"] == 1
    assert kept.cached_statistics().classes["urn:C"] == 1


def test_nothing_is_known_before_somebody_counts() -> None:
    """Reading the cached statistics never counts."""
    assert SnapshotCache(None, snapshot_of(SMALL)).cached_statistics() == Statistics()


def test_the_example_workspace_has_its_classes(examples: EmbeddedSnapshot) -> None:
    """In the example workspace the numbers are those of queries."""
    found = count(examples)
    rows = examples.query("SELECT (COUNT(*) AS ?n) { ?s a rnkg:NodeType }", prefixes=PREFIXES)
    assert str(found.classes[PREFIXES["rnkg"] + "NodeType"]) == next(iter(rows))[0].value  # type: ignore[arg-type] # rows of a SELECT


def test_what_is_typed_fills_no_disk(tmp_path: Path) -> None:
    """Values are cached for the store's classes, not for each typed name."""
    snapshot = snapshot_of('INSERT DATA { <urn:x> a <urn:C> ; <urn:p> "apple" }', 1)
    kept = SnapshotCache(tmp_path, snapshot)
    kept.statistics(fresh=True)

    def offered(kind: str) -> list[str]:
        text = f'SELECT * {{ ?s a <{kind}> ; <urn:p> "a'
        return [item["label"] for item in complete(text, len(text), kept, list)["items"]]

    assert offered("urn:C") == ["apple"]
    files = sorted(tmp_path.rglob("*"))
    assert [offered(f"urn:unknown:{number}") for number in range(3)] == [[], [], []]
    assert sorted(tmp_path.rglob("*")) == files
