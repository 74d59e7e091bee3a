from __future__ import annotations

import shutil
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Final

import pytest
from cli.rover import build

from kg.errors import UnknownNameError
from kg.pipeline.watching import glances
from kg.settings import load

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from kg.pipeline.watching import Glance

CASE: Final = Path(__file__).parent.parent / "cli" / "rules_case"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder with rules, as the working folder."""
    shutil.copytree(CASE, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def watched(steps: list[Callable[[], object]], *named: str) -> list[Glance]:
    """Return the reports at first and after each step; a step runs while the watcher waits."""
    waiting: Iterator[Callable[[], object]] = iter(steps)
    return list(islice(glances(load({}, environment={}), named, lambda _: next(waiting)()), len(steps) + 1))


def edit(path: Path, old: str, new: str) -> None:
    """Replace a part of a file."""
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_a_rule_is_looked_at_when_it_is_saved(folder: Path) -> None:
    """At first all user rules are reported, then changed ones: findings, examples, and the difference in the store."""
    build(folder / ".kg")
    rule = folder / "rules" / "wiring" / "talks-to.rq"
    first, second, third, fourth = watched(
        [
            lambda: edit(rule, "?speaker != ?listener", "?speaker = ?listener"),
            lambda: edit(rule, "CONSTRUCT", "CONSTRUC"),
            lambda: edit(rule, "CONSTRUC", "CONSTRUCT"),
        ],
        "wiring",
    )
    assert first.names == ("wiring/reaches", "wiring/silent", "wiring/talks-to")
    assert all(result.passed for result in first.results)
    assert first.difference is not None
    assert ("+", "wiring/talks-to") in {
        (change.sign, change.rules[0]) for change in first.difference.changes if change.rules
    }
    assert second.names == ("wiring/talks-to",)
    assert [result.passed for result in second.results] == [False, True]
    assert [finding.code for finding in third.findings if finding.severity == "error"] == ["KG201"]
    assert (third.results, third.difference) == ((), None)
    assert fourth.findings != third.findings
    assert len(fourth.results) == 2


def test_pages_of_examples_are_watched_too(folder: Path) -> None:
    """Saving the examples runs them; a deleted rule is named."""
    page = folder / "rules" / "wiring" / "talks-to.md"
    rule = folder / "rules" / "wiring" / "silent.rq"
    _, second, third = watched([lambda: edit(page, "## A planner", "## The planner"), rule.unlink], "wiring")
    assert second.results[0].title == "The planner talks to a driver"
    assert (third.names, third.gone) == ((), ("wiring/silent",))


def test_without_a_store_there_is_nothing_to_compare_with(folder: Path) -> None:
    """Findings and examples are still reported."""
    (first,) = watched([], "talks-to")
    assert (first.difference, first.view, len(first.results)) == (None, None, 2)
    assert folder.exists()


def test_others_that_cannot_be_read_keep_the_difference_away(folder: Path) -> None:
    """The problem is reported; so is the rest."""
    build(folder / ".kg")
    (folder / "rules" / "wiring" / "bad.rq").write_text("CONSTRUCT {")
    (first,) = watched([], "talks-to")
    assert first.difference is None
    assert first.problem is not None
    assert first.problem.code == "KG201"


def test_rules_not_named_are_not_told(folder: Path) -> None:
    """With names, only those rules are reported; an unknown name is KG001."""
    rules = folder / "rules" / "wiring"

    def save_two() -> None:
        edit(rules / "silent.rq", "since: 0.1", "since: 0.2")
        edit(rules / "reaches.srl", "since: 0.1", "since: 0.2")

    _, second = watched([save_two], "reaches")
    assert second.names == ("wiring/reaches",)
    with pytest.raises(UnknownNameError, match="KG001"):
        watched([], "reachs")
