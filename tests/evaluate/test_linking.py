"""Tables 8 and 10 on the example workspace, compared with the script that scores interfaces."""

from __future__ import annotations

import importlib.util
import json
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from repository import ROOT

from kg import api, settings
from kg.errors import UsageError
from kg.evaluate.completeness import completeness, correctness
from kg.evaluate.linking import forget, keep
from kg.evaluate.references import Choice, _same, gather
from kg.evaluate.tables import Share, as_objects
from kg.query import stored
from kg.query.core import run
from kg.query.result import Solutions

if TYPE_CHECKING:
    from evaluate.conftest import Field

    from kg.evaluate.tables import Table

CASES = Path(__file__).parent / "cases"
TOOL = ROOT.parent / "shared" / "tools" / "score_interfaces.py"


def counted(table: Table, column: str) -> dict[str, tuple[int, int]]:
    """Return the shares of a column by the second one."""
    place = table.columns.index(column)
    return {str(row[1]): (cell.part, cell.whole) for row in table.rows if isinstance(cell := row[place], Share)}


def test_entities_that_references_name(field: Field) -> None:
    """Entities with the same name and role in a package match, including topics of actions and names with holes."""
    with field.store.read() as snapshot:
        table, ground = completeness(snapshot, [CASES / "truth.jsonl"], Choice())
    assert counted(table, "known") == {
        "node": (4, 5),
        "topic": (8, 8),
        "service": (1, 2),
        "action": (1, 1),
        "parameter": (2, 3),
        "message type": (6, 7),
        "service type": (1, 2),
        "action type": (1, 1),
    }
    assert len(ground.linked) == 5
    assert "1 repository not in the store" in table.notes[1]


def test_relations_of_references(field: Field) -> None:
    """Recall requires the exact node; precision is computed only if a reference names all of a role."""
    with field.store.read() as snapshot:
        table, _ = correctness(snapshot, [CASES / "truth.jsonl"], Choice())
    assert counted(table, "recall") == {
        "publishes": (5, 6),
        "subscribes": (2, 2),
        "provides": (1, 2),
        "calls action": (1, 1),
        "has parameter": (2, 3),
        "all of these": (11, 14),
        "has type": (7, 10),
    }
    assert counted(table, "precision") == {
        "publishes": (2, 2),
        "subscribes": (1, 1),
        "provides": (1, 1),
        "all of these": (4, 4),
        "has type": (7, 8),
    }
    (row,) = (row for row in as_objects(table) if row["relation"] == "provides")
    assert row["F1"] == pytest.approx(2 / 3)


def test_references_that_name_all(field: Field) -> None:
    """With `closed` every role of a reference counts for precision."""
    with field.store.read() as snapshot:
        table, _ = correctness(snapshot, [CASES / "truth.jsonl"], Choice(closed=True))
    assert counted(table, "precision")["has parameter"][0] == 2


def test_pages_speak_of_the_package_around_them(field: Field, tmp_path: Path) -> None:
    """A wiki page and a README belong to their folder's package, or the named one; others are rejected."""
    page = field.source / "rover" / "rover_robot" / "page.txt"
    shutil.copy(CASES / "wiki.txt", page)
    outside = Path(shutil.copy(CASES / "readme.md", tmp_path / "README.md"))
    try:
        with field.store.read() as snapshot:
            table, _ = completeness(snapshot, [page], Choice())
            named, _ = completeness(snapshot, [outside], Choice(package="drone_control"))
            below = gather(snapshot, [field.source, tmp_path], Choice())
            for choice, words in ((Choice(), "no package"), (Choice(package="drone_controls"), "no package `drone")):
                with pytest.raises(UsageError, match=words) as raised:
                    gather(snapshot, [outside], choice)
                assert raised.value.code == "KG723"
    finally:
        page.unlink()
    assert counted(table, "known") == {"node": (1, 1), "topic": (2, 3), "message type": (2, 3), "parameter": (1, 1)}
    assert counted(named, "known")["parameter"] == (2, 2)
    assert [len(one.references) for one in below] == [1, 0]
    assert below[1].left_out == {"page in no package of the store": 1}


@pytest.mark.parametrize(
    ("said", "read", "same"),
    [("0123ab", "0123", True), ("0123", "0123ab", True), ("0124", "0123", False), (None, "0123", True)],
)
def test_commits_are_compared_as_far_as_they_are_said(said: str | None, read: str, same: bool) -> None:  # noqa: FBT001 - a case
    """An abbreviated commit matches; a reference without a commit is accepted."""
    assert _same(said, read) is same


def test_kept_references_answer_stored_queries(field: Field, tmp_path: Path) -> None:
    """The queries give the same over the whole store; after removal, they give nothing."""
    copy = settings.load({"store": tmp_path / "store"})
    shutil.copytree(str(field.settings.store), tmp_path / "store")
    with field.store.read() as snapshot:
        _, ground = completeness(snapshot, [CASES / "truth.jsonl"], Choice())
    keep(copy, ground.triples)
    keep(copy, ground.triples)
    for name in ("completeness/reference-entities", "correctness/reference-recall", "correctness/reference-precision"):
        assert rows(copy, name) == ground.counts(name)
    assert forget(copy)
    assert not forget(copy)
    assert rows(copy, "completeness/reference-entities") == {}


def rows(given: settings.Settings, name: str) -> dict[str, dict[str, int]]:
    """Return the result of a stored query on a store."""
    with api.open_store(given.store).read() as snapshot:
        answer = run(snapshot, stored.find(name).text)
    assert isinstance(answer, Solutions)
    texts = [[str(getattr(cell, "value", "")) for cell in row] for row in answer.rows]
    return {row[0]: dict(zip(answer.variables[1:], map(int, row[1:]), strict=True)) for row in texts}


def test_recall_is_that_of_the_script_that_scores_interfaces(field: Field) -> None:
    """Recall of names and of names with types, by role at the exact node, equals that of the shared script."""
    if not TOOL.is_file():
        pytest.skip(f"{TOOL} is not there")
    spec = importlib.util.spec_from_file_location("score_interfaces", TOOL)
    assert spec is not None
    assert spec.loader is not None
    tool: Any = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    truths = [json.loads(line) for line in (CASES / "truth.jsonl").read_text().splitlines() if line.strip()]
    truths = [one for one in truths if one["package"] and "elsewhere" not in one["repo"] and "commit" not in one]
    counts, _ = tool.score(truths, api.nodes(store=field.settings.store), "node")
    with field.store.read() as snapshot:
        _, ground = correctness(snapshot, [CASES / "truth.jsonl"], Choice())
    ours = ground.counts("correctness/reference-recall")
    for role, numbers in ours.items():
        assert (numbers["stated"], numbers["had"]) == (counts[role]["wanted"], counts[role]["named"]), role
