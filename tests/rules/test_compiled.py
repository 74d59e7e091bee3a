"""Tests of rules cached for the next process."""

from __future__ import annotations

import pickle
from hashlib import blake2b
from typing import TYPE_CHECKING

import pytest

from kg import resources
from kg.rules import compiled
from kg.rules.reading import discover
from kg.rules.specialise import specialised
from kg.rules.stratify import stratify

if TYPE_CHECKING:
    from pathlib import Path

    from kg.rules.files import RuleSet


@pytest.fixture(scope="module")
def shipped() -> RuleSet:
    """The rules shipped with `kg`, of every notation, without axioms."""
    return specialised(discover([resources.folder("rules")]), ())


def test_rules_come_back_equal(tmp_path: Path, shipped: RuleSet) -> None:
    """The loaded rules and data equal the saved ones, in their order."""
    saved = compiled.save(tmp_path, "mark", shipped)
    loaded = compiled.load(tmp_path, "mark")
    assert loaded == saved
    assert (loaded.rules, loaded.data) == (shipped.rules, shipped.data)


def test_the_order_of_rules_and_their_digest_come_back(tmp_path: Path, shipped: RuleSet) -> None:
    """They equal those computed without the cache."""
    compiled.save(tmp_path, "mark", shipped)
    loaded = compiled.load(tmp_path, "mark")
    assert loaded is not None
    assert list(loaded.strata) == stratify(shipped.rules, bounded=True)
    assert loaded.digest == loaded.cached_digest == shipped.digest


def test_rules_are_kept_uncut_beside_those_that_are_cut(tmp_path: Path, shipped: RuleSet) -> None:
    """Unordered rules come back with the prefixes of their files, and the cached ones for evaluation remain."""
    compiled.save(tmp_path, "mark", shipped)
    uncut = discover([resources.folder("rules")])
    saved = compiled.save(tmp_path, "mark", uncut, cut=False)
    loaded = compiled.load(tmp_path, "mark", cut=False)
    assert loaded == saved
    assert (loaded.rules, loaded.data, loaded.strata) == (uncut.rules, uncut.data, ())
    assert loaded.files[0].prefixes == {name: iri for one in uncut.files for name, iri in one.prefixes.items()}
    kept = compiled.load(tmp_path, "mark")
    assert kept is not None
    assert kept.rules == shipped.rules


def test_rules_of_something_else_are_none(tmp_path: Path, shipped: RuleSet) -> None:
    """Rules made from other files, and a damaged or missing file, give none."""
    assert compiled.load(tmp_path, "mark") is None
    compiled.save(tmp_path, "mark", shipped)
    assert compiled.load(tmp_path, "another mark") is None
    path = next(tmp_path.iterdir())
    path.write_bytes(path.read_bytes()[:-1])
    assert compiled.load(tmp_path, "mark") is None


class _Harmful:
    """An object that runs code when unpickled."""

    def __init__(self, target: Path) -> None:
        self.target = target

    def __reduce__(self) -> tuple[object, ...]:
        return exec, (f"open({str(self.target)!r}, 'w').close()",)


def test_nothing_but_rules_is_made(tmp_path: Path, shipped: RuleSet) -> None:
    """A file with the right digests that names other code is rejected, and the code does not run."""
    compiled.save(tmp_path, "mark", shipped)
    path, target = next(tmp_path.iterdir()), tmp_path / "made"
    packed = pickle.dumps((_Harmful(target), ()))
    digests = (blake2b(content, digest_size=16).digest() for content in (b"mark", packed))
    path.write_bytes(b"".join(digests) + packed)
    assert compiled.load(tmp_path, "mark") is None
    assert not target.exists()
