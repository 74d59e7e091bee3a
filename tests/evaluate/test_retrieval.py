"""Table 11 on the example workspace; gains compared with the script that scores searches."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from repository import ROOT

from kg.errors import UsageError
from kg.evaluate.retrieval import (
    Constraints,
    Judged,
    Need,
    Patterns,
    Ranked,
    _compared,
    embeddings,
    library,
    ndcg,
    read_needs,
    retrieval,
)
from kg.evaluate.tables import Score
from kg.search.documents import Document, End
from kg.search.searching import open_search

if TYPE_CHECKING:
    from evaluate.conftest import Field

    from kg.evaluate.tables import Table

CASES = Path(__file__).parent / "cases"
TOOL = ROOT.parent / "shared" / "tools" / "score_search.py"
NAMES = st.sampled_from(["a", "b", "x::a", "c.py"])
JUDGED = st.builds(Judged, st.just("o/r"), st.sampled_from("pq"), NAMES, st.integers(0, 3), st.tuples(NAMES))
RANKED = st.builds(Ranked, st.just("git.example/O/R"), st.sampled_from("pq"), NAMES)


def means(table: Table) -> dict[tuple[str, str], float]:
    """Return the means by method and measure."""
    return {(str(row[0]), str(row[1])): row[2].value for row in table.rows if isinstance(row[2], Score)}


def test_ways_to_find_nodes_are_compared(field: Field) -> None:
    """Each method has its means; a method that ranks the one right node first has means of one."""
    pytest.importorskip("sklearn", reason="the extra `evaluate` is not installed")
    pytest.importorskip("rapidfuzz", reason="the extra `evaluate` is not installed")
    pytest.importorskip("networkx", reason="the extra `evaluate` is not installed")
    needs = read_needs(CASES / "needs.jsonl")
    search = open_search(field.store)
    found = means(retrieval(search, needs))
    assert {method for method, _ in found} == {"TF-IDF", "fuzzy names", "subgraph matching", "kg search"}
    assert found["subgraph matching", "NDCG@1"] == pytest.approx(2 / 3)
    assert found["kg search", "NDCG@5"] > 0.5
    single = means(retrieval(search, needs[:1]))
    assert single["subgraph matching", "NDCG@5"] == 1.0
    assert retrieval(search, needs) == retrieval(search, needs)


def test_nothing_is_so_and_so_many_times_better_than_what_finds_nothing() -> None:
    """Compared with a method whose mean is zero, there is a difference, and no ratio."""
    difference, share = _compared([0.5, 1.0], [0.0, 0.0])
    assert isinstance(difference, Score)
    assert difference.value == 0.75
    assert share is None
    share = _compared([0.5, 1.0], [0.5, 0.5])[1]
    assert isinstance(share, Score)
    assert share.value == 0.5


def test_a_pattern_asks_for_ends_of_its_own() -> None:
    """Two ends of one type require two, of one role; actions count as services; no constraint finds nothing."""

    def node(*ends: tuple[str, str]) -> Document:
        made = tuple(End(role, None, kind, "", 1) for role, kind in ends)
        return Document("i", "n", "script", 0, 1, "", 1, ends=made)

    scan = ("subscribes", "s/Scan")
    patterns = Patterns(
        [node(scan), node(scan, scan), node(("publishes", "s/Scan"), scan), node(("clients", "s/Scan"))]
    )
    assert patterns.scores(Constraints(subscribes=("s/Scan",))) == [1.0, 0.5, 0.5, 0.0]
    assert patterns.scores(Constraints(subscribes=("s/Scan", "s/Scan"))) == [0.0, 0.5, 0.0, 0.0]
    assert patterns.scores(Constraints(calls=("s/Scan",), publishes=("s/Scan",))) == [0.0] * 4
    assert patterns.scores(None) == [0.0] * 4


@given(st.lists(JUDGED, max_size=4), st.lists(RANKED, max_size=6), st.integers(1, 5))
def test_gains_are_those_of_the_script_that_scores_searches(
    judged: list[Judged], ranked: list[Ranked], depth: int
) -> None:
    """NDCG equals that of the shared script, and lies between 0 and 1."""
    found = ndcg(Need("n", "q", tuple(judged)), ranked, depth)
    assert 0 <= found <= 1 + 1e-9
    if TOOL.is_file():
        tool = _tool()
        query = {"relevant": [msgspec.to_builtins(one) for one in judged]}
        assert found == pytest.approx(tool.ndcg(query, [msgspec.to_builtins(one) for one in ranked], depth))


def _tool() -> Any:
    spec = importlib.util.spec_from_file_location("score_search", TOOL)
    assert spec is not None
    assert spec.loader is not None
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    return tool


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "has no need"),
        ("{}", "invalid need"),
        ('{"id": "a", "query": "b", "relevant": [{"repo": "c"}]}', "invalid need"),
        ('{"id": "a", "query": "b", "relevant": [{"repo": "c", "package": "p", "node": "n", "grade": 99}]}', "grade"),
    ],
)
def test_a_file_without_needs_is_refused(tmp_path: Path, text: str, words: str) -> None:
    """The error names the fault; so does that about a missing file."""
    (tmp_path / "needs").write_text(text)
    with pytest.raises(UsageError, match=words) as raised:
        read_needs(tmp_path / "needs")
    assert raised.value.code == "KG725"
    with pytest.raises(UsageError, match="cannot be read"):
        read_needs(tmp_path / "none")


def test_a_library_that_is_missing_is_named() -> None:
    """The error explains the installation."""
    with pytest.raises(UsageError, match="is not installed") as raised:
        library("kg_no_such_library", "no-such-library")
    assert raised.value.hint == "pip install 'kg-ros[evaluate]'"


def test_embeddings_of_a_model(field: Field, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A model in a folder is an additional method; a missing one is rejected."""
    module = ModuleType("sentence_transformers")

    class Letters:
        """A model that counts letters."""

        def __init__(self, _: str, *, local_files_only: bool) -> None:
            assert local_files_only

        def encode(self, texts: list[str], *, normalize_embeddings: bool, **_: object) -> Any:
            """Return the shares of letters."""
            assert normalize_embeddings
            found = np.array([[text.count(letter) for letter in "abcdefghijklmnopqrstuvwxyz"] for text in texts])
            return found / np.linalg.norm(found, axis=1, keepdims=True)

    module.SentenceTransformer = Letters  # type: ignore[attr-defined]  # a module made here
    monkeypatch.setitem(sys.modules, "sentence_transformers", module)
    (tmp_path / "modules.json").write_text("[]")
    search = open_search(field.store)
    needs = read_needs(CASES / "needs.jsonl")
    scores = embeddings(search.index, tmp_path)(needs[0])
    assert len(scores) == search.index.size
    assert max(scores) <= 1.000001
    with pytest.raises(UsageError, match="no model"):
        embeddings(search.index, tmp_path / "none")
