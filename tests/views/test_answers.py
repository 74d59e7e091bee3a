from __future__ import annotations

import json
from typing import TYPE_CHECKING, Final

import pytest

from kg.graph.reading import overview
from kg.graph.reading.nodes import node_records
from kg.graph.records import node_object
from kg.query.stats import counted, statistics
from kg.views import answers

if TYPE_CHECKING:
    from pathlib import Path

    from kg.query.stats import Statistics
    from kg.store.snapshot import EmbeddedSnapshot

VERSION: Final = 7


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of cached counts, empty, and outside of the store, which other workers use too."""
    monkeypatch.setattr(answers, "_version", lambda: VERSION)
    monkeypatch.setattr(answers, "_FOLDER", str(tmp_path))  # absolute, so it replaces that of the store
    return tmp_path / "stats"


def test_kept_answers_are_those_of_the_store(snapshot: EmbeddedSnapshot, folder: Path) -> None:
    """Computed and cached answers equal those of the store."""
    for _ in range(2):
        found = answers.figures(snapshot)
        assert (found.graph, found.rnkg) == (statistics(snapshot), counted(snapshot))
        for kind in ("topic", "service", "action"):
            for implicit in (False, True):
                expected = overview.channels(snapshot, kind, implicit=implicit)
                assert answers.channels(snapshot, kind, implicit=implicit) == expected
        assert answers.node_summaries(snapshot) == overview.nodes(snapshot)
        lines = answers.node_lines(snapshot)
        records = node_records(snapshot)
        assert [json.loads(one.text) for one in lines] == [json.loads(json.dumps(node_object(one))) for one in records]
        assert [one.kind for one in lines] == [str(one.node.kind) for one in records]
    assert [path.name for path in folder.iterdir()] == [snapshot.identity]


@pytest.mark.parametrize("change", ["damaged", "of other code", "of another generation"])
def test_answers_that_cannot_be_used_are_computed_again(
    snapshot: EmbeddedSnapshot, folder: Path, monkeypatch: pytest.MonkeyPatch, change: str
) -> None:
    """A damaged file, one from other code, or one of other data, counts as missing."""
    expected = answers.figures(snapshot)
    file = folder / snapshot.identity
    if change == "damaged":
        file.write_bytes(file.read_bytes().replace(b'"quads":', b'"quads":9'))
    elif change == "of other code":
        monkeypatch.setattr(answers, "_version", lambda: VERSION + 1)
    else:
        file.rename(folder / "0")
    computed: list[EmbeddedSnapshot] = []

    def counting(graph: EmbeddedSnapshot) -> Statistics:
        computed.append(graph)
        return statistics(graph)

    monkeypatch.setattr("kg.query.stats.statistics", counting)
    assert answers.figures(snapshot) == expected
    assert answers.figures(snapshot) == expected
    assert len(computed) == 1
    assert [path.name for path in folder.iterdir()] == [snapshot.identity]


def test_answers_are_computed_while_code_changes(
    snapshot: EmbeddedSnapshot, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing is cached while another change of a code file could remain undetected."""
    monkeypatch.setattr(answers, "_version", lambda: None)
    assert answers.figures(snapshot).graph == statistics(snapshot)
    assert not list(folder.glob("*"))
