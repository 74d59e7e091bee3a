"""Tests of rules cached for the next process."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.errors import RuleError
from kg.pipeline import reasoning
from kg.settings import load

if TYPE_CHECKING:
    from pathlib import Path

    from kg.rules.files import RuleSet
    from kg.settings import Settings

_RULE = """# Things are things
#
# ## What it infers
#
# That what has a name is a thing.
#
# ## Why
#
# For this test.

CONSTRUCT { ?x a rnkg:%s } WHERE { ?x rnkg:name ?name }
"""


@pytest.fixture
def own(tmp_path: Path) -> Settings:
    """Settings with a folder that contains one rule."""
    _write(tmp_path, "Thing")
    return load({"rules": str(tmp_path / "rules")}, environment={})


def _write(folder: Path, name: str) -> None:
    file = folder / "rules" / "own" / "thing.rq"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(_RULE % name, encoding="utf-8")


def _read_again(settings: Settings, cache: Path) -> RuleSet:
    """Return the enabled rules as another process reads them."""
    reasoning._read_before.cache_clear()
    return reasoning.rules_in_force(settings, cache=cache)


def test_rules_are_the_same_from_the_cache(own: Settings, tmp_path: Path) -> None:
    """The first process reads the files, the second the cache; both get the same rules."""
    expected = reasoning.rules_in_force(own)
    for _ in range(2):
        found = _read_again(own, tmp_path)
        assert (found.rules, found.data) == (expected.rules, expected.data)


def test_a_rule_that_changed_is_read_again(own: Settings, tmp_path: Path) -> None:
    """After an edit the rules are those of the files, not of the cache."""
    before = _read_again(own, tmp_path)
    _write(tmp_path, "Other")
    after = _read_again(own, tmp_path)
    assert after.rules != before.rules
    assert after.rules == reasoning.rules_in_force(own).rules


def test_rules_are_read_where_nothing_can_be_kept(own: Settings, tmp_path: Path) -> None:
    """An unusable or read-only cache is ignored."""
    (tmp_path / "file").write_text("", encoding="utf-8")
    assert _read_again(own, tmp_path / "file").rules == reasoning.rules_in_force(own).rules


def test_rules_with_errors_are_not_kept(own: Settings, tmp_path: Path) -> None:
    """Each process reports an unusable file as long as it exists."""
    (tmp_path / "rules" / "own" / "thing.rq").write_text("no rule", encoding="utf-8")
    for _ in range(2):
        with pytest.raises(RuleError):
            _read_again(own, tmp_path)
