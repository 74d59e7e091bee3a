from __future__ import annotations

import shutil
from importlib.metadata import EntryPoint
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import pytest

from kg.errors import RuleError
from kg.rules import reading
from kg.rules.reading import ENTRY_POINTS, Pack, discover, packs, read, read_text

if TYPE_CHECKING:
    from collections.abc import Callable

RQ = "# Title\nCONSTRUCT { ?s rnkg:q ?o } WHERE { ?s rnkg:p ?o }\n"
SRL = "PREFIX : <http://e/>\nRULE { ?s :q ?o } WHERE { ?s :p ?o }\n"
TTL = """\
# Title
@prefix sh: <http://www.w3.org/ns/shacl#> .
@prefix : <http://e/> .
:shape a sh:NodeShape ; sh:targetClass :C ;
  sh:rule [ a sh:TripleRule ; sh:subject sh:this ; sh:predicate :q ; sh:object :o ] .
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a rule of each notation and other files."""
    files = {
        "family/one.rq": RQ,
        "family/one.md": "examples",
        "family/deep/two.srl": SRL,
        "three.ttl": TTL,
        "README.md": "",
        ".hidden/four.rq": "nonsense",
    }
    for name, text in files.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path


def code_of(action: Callable[[], object]) -> str:
    """Return the code of the raised error."""
    with pytest.raises(RuleError) as caught:
        action()
    assert caught.value.place is not None
    return caught.value.code


def test_rules_of_all_notations_are_found(folder: Path) -> None:
    """A folder gives its rule files sorted by name, each parsed by its notation."""
    found = discover([folder])
    assert [file.name for file in found.files] == ["family/deep/two", "family/one", "three"]
    assert [file.notation for file in found.files] == [".srl", ".rq", ".ttl"]
    assert {rule.name for rule in found.rules} == {"family/deep/two", "family/one", "three"}
    assert found.files[1].documentation.title == "Title"


def test_a_file_can_be_given_instead_of_a_folder(folder: Path) -> None:
    """A single file is named after its folder and itself."""
    (file,) = discover([folder / "family" / "one.rq"]).files
    assert file.name == "family/one"


def test_rules_of_packs_carry_the_name_of_the_pack(folder: Path) -> None:
    """A rule file of a pack has the name of the pack."""
    assert {file.pack for file in discover([], [Pack("mine", folder)]).files} == {"mine"}


def test_two_files_of_one_name_are_refused(folder: Path, tmp_path: Path) -> None:
    """Two suffixes or two folders may not give one name (KG207)."""
    (folder / "family" / "one.srl").write_text(SRL)
    assert code_of(lambda: discover([tmp_path])) == "KG207"


def test_a_copy_is_no_other_rule(folder: Path, tmp_path: Path) -> None:
    """A folder given twice, such as a checkout and its installation, has each rule once; a difference is reported."""
    copy = shutil.copytree(folder, tmp_path.parent / f"{tmp_path.name}-copy")
    assert discover([folder, copy]) == discover([folder])
    (copy / "family" / "one.rq").write_text(RQ.replace("rnkg:q", "rnkg:r"))
    assert code_of(lambda: discover([folder, copy])) == "KG207"


def test_a_missing_folder_is_refused(tmp_path: Path) -> None:
    """A missing folder is an error, not an empty set."""
    assert code_of(lambda: discover([tmp_path / "nowhere"])) == "KG231"


def test_a_file_that_cannot_be_read_is_refused(tmp_path: Path) -> None:
    """A missing file is KG231, a binary one or one of no notation KG201."""
    (tmp_path / "latin.rq").write_bytes(b"# caf\xe9\n")
    assert code_of(lambda: read(tmp_path / "nowhere.rq", "x")) == "KG231"
    assert code_of(lambda: read(tmp_path / "latin.rq", "x")) == "KG201"
    assert code_of(lambda: read_text(RQ, Path("x.txt"), "x")) == "KG201"


def test_an_editor_reads_text_that_is_not_saved() -> None:
    """The text of a file can be passed in place of the file."""
    assert read_text("\n" + RQ.replace("rnkg:q", "rnkg:r"), Path("family/x.rq"), "family/x").rules


def test_imported_rules_come_once(tmp_path: Path) -> None:
    """A file imported by two rule sets, and also found directly, is in the set once."""
    (tmp_path / "a.srl").write_text("IMPORTS <lib/c.srl>\nIMPORTS <../outside.srl>\n" + SRL)
    (tmp_path / "b.srl").write_text("IMPORTS <lib/c.srl>\nIMPORTS <../outside.srl>\n" + SRL)
    inner = tmp_path / "rules"
    inner.mkdir()
    for name in ("a.srl", "b.srl"):
        (tmp_path / name).rename(inner / name)
    (inner / "lib").mkdir()
    (inner / "lib" / "c.srl").write_text(SRL)
    (tmp_path / "outside.srl").write_text(SRL)
    found = {file.name: [Path(rule.place.path).name for rule in file.rules] for file in discover([inner]).files}
    assert found == {"a": ["a.srl", "outside.srl"], "b": ["b.srl"], "lib/c": ["c.srl"]}


def test_parts_of_a_rule_set_are_numbered_through_imports(tmp_path: Path) -> None:
    """Rules of a file and of its imports have different part numbers."""
    (tmp_path / "a.srl").write_text("IMPORTS <b.srl>\n" + SRL)
    (tmp_path / "b.srl").write_text(SRL + "RULE { } WHERE { }\n")
    assert [rule.part for rule in read(tmp_path / "a.srl", "a").rules] == [1, 2]


def entry(name: str, loaded: object, monkeypatch: pytest.MonkeyPatch) -> None:
    """Declare one pack that loads to `loaded`, or fails with it."""

    def load(_: EntryPoint) -> object:
        if isinstance(loaded, Exception):
            raise loaded
        return loaded

    monkeypatch.setattr(EntryPoint, "load", load)
    monkeypatch.setattr(reading, "_declared", lambda *_: (EntryPoint(name, "package", ENTRY_POINTS),))


def test_a_pack_is_a_package_or_a_function(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An entry point of the group kg.rules names a package, whose folder it is, or a function that returns one."""
    package = ModuleType("package")
    package.__file__ = str(folder / "__init__.py")
    for loaded in (package, lambda: folder):
        entry("mine", loaded, monkeypatch)
        assert packs() == (Pack("mine", folder),)


def test_a_broken_pack_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A pack that fails to load, or whose folder is missing, is KG208."""
    for loaded in (ImportError("gone"), lambda: tmp_path / "nowhere"):
        entry("mine", loaded, monkeypatch)
        assert code_of(packs) == "KG208"
