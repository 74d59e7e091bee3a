from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.errors import UsageError
from kg.rules.authoring.examples import read_examples
from kg.rules.authoring.starting import start

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize("notation", ["rq", "ttl", "srl", ".RQ"])
def test_a_new_rule_has_its_examples_beside_it(tmp_path: Path, notation: str) -> None:
    """Two files are written; their texts are derived from the name."""
    rule, examples = start("wiring/listens-to", tmp_path / "rules", notation)
    assert (rule.stem, examples.name) == ("listens-to", "listens-to.md")
    assert rule.read_text().startswith("# Listens to\n")
    assert "my:listensTo" in rule.read_text()
    assert "{" in rule.read_text()
    assert "{{" not in rule.read_text()
    assert len(read_examples(examples)) == 2


def test_a_rule_is_never_overwritten(tmp_path: Path) -> None:
    """A file of that name in any notation, or examples without a rule, remain unchanged."""
    start("wiring/listens-to", tmp_path)
    with pytest.raises(UsageError, match=r"listens-to\.rq already"):
        start("wiring/listens-to", tmp_path, "ttl")
    (tmp_path / "wiring" / "other.md").write_text("mine")
    with pytest.raises(UsageError, match=r"other\.md already"):
        start("wiring/other", tmp_path)
    assert (tmp_path / "wiring" / "other.md").read_text() == "mine"


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("listens-to", "Did you mean `mine/listens-to`?"),
        ("Wiring/Listens To", "Did you mean `wiring/listens-to`?"),
        ("wiring/listens-to.rq", "Did you mean `wiring/listens-to`?"),
        ("../x/y", "Did you mean `x/y`?"),
        ("/", "For example wiring/listens-to."),
    ],
)
def test_a_name_of_another_form_is_refused_with_one_that_would_do(tmp_path: Path, name: str, hint: str) -> None:
    """KG003, and nothing is written."""
    with pytest.raises(UsageError) as caught:
        start(name, tmp_path)
    assert (caught.value.code, caught.value.hint) == ("KG003", hint)
    assert not list(tmp_path.iterdir())


def test_a_notation_that_is_not_there_is_refused(tmp_path: Path) -> None:
    """KG003 lists the valid ones."""
    with pytest.raises(UsageError) as caught:
        start("a/b", tmp_path, "datalog")
    assert caught.value.hint == "The notations are rq, ttl, srl."


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    """A file in place of the folder is KG003 with its name."""
    (tmp_path / "rules").write_text("")
    with pytest.raises(UsageError, match="Not a directory") as caught:
        start("a/b", tmp_path / "rules")
    assert (caught.value.code, caught.value.hint) == ("KG003", "Name another folder with `--rules`.")
