from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest
from rules.authoring.worlds import write_rules

from kg import resources
from kg.errors import KgError, RuleError, UsageError
from kg.rules.authoring.library import Library, Watched
from kg.rules.authoring.starting import choose, find_rule
from kg.rules.reading import families_in_force, own_folder, read, rule_files, user_folders
from kg.settings import load

if TYPE_CHECKING:
    from pathlib import Path

RULE = "CONSTRUCT { ?x :p ?y } WHERE { ?x :q ?y }"


@pytest.fixture
def library(tmp_path: Path) -> Library:
    """Return two families of rules, of which one is optional, and one rule with a syntax error."""
    write_rules(tmp_path, one=RULE, two=RULE, broken="CONSTRUCT {")
    (tmp_path / "g").mkdir()
    (tmp_path / "g" / "optional").write_text("for a test")
    (tmp_path / "g" / "two.rq").write_text((tmp_path / "f" / "two.rq").read_text())
    return Library([tmp_path])


def names(library: Library, *wanted: str) -> list[str]:
    """Return the selected rules."""
    return [entry.name for entry in choose(library, wanted)]


def test_a_file_that_does_not_parse_hides_no_other(library: Library) -> None:
    """Each file is parsed separately; the errors are reported."""
    files, errors = library.read_all()
    assert [file.name for file in files] == ["f/one", "f/two"]
    assert [error.code for error in errors] == ["KG201"]
    with pytest.raises(RuleError, match="KG201"):
        library.with_those_in_force()


def test_rules_are_meant_by_name_family_file_and_folder(
    library: Library, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without a name the active rules are selected; the last part of a name is enough."""
    monkeypatch.chdir(tmp_path)
    assert names(library) == ["f/broken", "f/one", "f/two"]
    assert names(library, "one") == ["f/one"]
    assert names(library, "two") == ["f/two", "g/two"]
    assert names(library, "g", "f/one") == ["f/one", "g/two"]
    (tmp_path / "f" / "two.md").write_text("")
    assert names(library, "f/one.rq", "f/two.md") == ["f/one", "f/two"]
    assert names(library, str(tmp_path / "f")) == ["f/broken", "f/one", "f/two"]


@pytest.mark.parametrize(
    ("name", "message", "hint"),
    [
        ("onee", "unknown rule `onee`", "Did you mean `one` or `f/one`?"),
        ("zzz", "unknown rule `zzz`", "`kg rules list` lists them."),
        ("two", "several rules are called `two`: f/two, g/two", "Give the whole name."),
    ],
)
def test_a_name_that_means_no_single_rule_is_refused(library: Library, name: str, message: str, hint: str) -> None:
    """KG001 with suggestions."""
    with pytest.raises(KgError) as caught:
        find_rule(library, name)
    assert (caught.value.code, caught.value.message, caught.value.hint) == ("KG001", message, hint)


def test_two_files_of_one_name_are_told(tmp_path: Path) -> None:
    """KG207 for the second; the first is used."""
    write_rules(tmp_path, one=RULE)
    (tmp_path / "f" / "one.srl").write_text("")
    library = Library([tmp_path])
    assert [error.code for error in library.problems] == ["KG207"]
    assert library.entries["f/one"].path.suffix == ".rq"


def test_copies_are_no_problem(tmp_path: Path) -> None:
    """The same file in two folders is one rule, with the first path."""
    for folder in (tmp_path / "a", tmp_path / "b"):
        write_rules(folder, one=RULE)
    library = Library([tmp_path / "a", tmp_path / "b"])
    assert library.problems == []
    assert library.entries["f/one"].path == tmp_path / "a" / "f" / "one.rq"


def test_what_was_saved(library: Library, tmp_path: Path) -> None:
    """A rule counts as saved when it, or its page of examples, is new or has another time."""
    watched = Watched(library)
    assert not watched.saved()
    os.utime(tmp_path / "f" / "one.rq", ns=(1, 1))
    (tmp_path / "f" / "two.md").write_text("## One\n")
    (tmp_path / "g" / "two.rq").unlink()
    (tmp_path / "f" / "three.rq").write_text("")
    saved = watched.saved()
    assert [entry.name for entry in saved.entries] == ["f/one", "f/three", "f/two"]
    assert saved.gone == ["g/two"]
    assert not watched.saved()


def test_the_folder_of_ones_own_rules(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By default it is rules/ next to kg.toml, or in the working folder; the setting `rules` names others."""
    deep = tmp_path / "a" / "b"
    deep.mkdir(parents=True)
    monkeypatch.chdir(deep)
    settings = load({}, environment={})
    assert own_folder(settings).absolute() == deep / "rules"
    assert user_folders(settings) == ()
    (tmp_path / "kg.toml").write_text("")
    (tmp_path / "rules").mkdir()
    assert user_folders(settings) == (tmp_path / "rules",)
    chosen = load({"rules": f"x{os.pathsep}y"}, environment={})
    with pytest.raises(UsageError, match=r"--rules names .*x, which is not there"):
        user_folders(chosen)
    (deep / "x").mkdir()
    (deep / "y").mkdir()
    assert (own_folder(chosen), user_folders(chosen)) == (deep / "x", (deep / "x", deep / "y"))


def test_the_rules_that_are_shipped_are_not_there_twice() -> None:
    """Developers of the shipped rules may name their folder."""
    settings = load({"rules": str(resources.folder("rules"))}, environment={})
    assert user_folders(settings) == ()
    assert not Library.of(settings).problems


def test_a_family_that_there_is_not_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The message has the place of the setting, and suggestions."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UsageError, match="KG_RULE_FAMILIES names an unknown family of rules, `comunication`") as caught:
        Library.of(load({}, environment={"KG_RULE_FAMILIES": "owl,comunication"}))
    assert (caught.value.hint or "").startswith("Did you mean `communication`")
    (tmp_path / "kg.toml").write_text('rule_families = ["+minds"]\n')
    with pytest.raises(UsageError) as caught:
        families_in_force(load({}, environment={}))
    assert str(caught.value.place).endswith("kg.toml:1")


def test_a_plus_adds_a_family_to_those_in_force() -> None:
    """Without one, only the named families are active."""

    def families(text: str) -> set[str]:
        return {entry.family for entry in Library.of(load({"rule_families": text}, environment={})).in_force}

    usual = {entry.family for entry in Library.of(load({}, environment={})).in_force}
    assert families("+owl-rl") == usual | {"owl-rl"}
    assert families("owl,+owl-rl") == {"owl", "owl-rl"}


def test_what_is_closed_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An unreadable folder or file of rules is an error, not skipped."""
    (tmp_path / "f").mkdir()
    file = tmp_path / "f" / "one.rq"
    file.write_text("")

    def refuse(path: object, *_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr("pathlib.Path.read_text", refuse)
    with pytest.raises(RuleError, match=r"KG231.*Permission denied") as caught:
        read(file, "f/one")
    assert str(caught.value.place) == str(file)
    monkeypatch.setattr("os.scandir", refuse)
    with pytest.raises(RuleError, match=r"KG231.*Permission denied") as caught:
        list(rule_files(tmp_path))
    assert str(caught.value.place) == str(tmp_path)


def test_a_family_is_the_first_part_of_a_name(tmp_path: Path) -> None:
    """A family may have folders; a file outside of all has no family, and is active if none is named."""
    for name in ("top", "f/one", "f/deep/two"):
        path = tmp_path / f"{name}.rq"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(RULE)
    entries = Library([tmp_path]).in_force
    assert {entry.name: entry.family for entry in entries} == {"top": "", "f/one": "f", "f/deep/two": "f"}
    assert [entry.name for entry in Library([tmp_path], families=["f"]).in_force] == ["f/deep/two", "f/one"]
