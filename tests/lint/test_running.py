from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from lint.robot import read

from kg.errors import UnknownNameError
from kg.lint.question import Question
from kg.lint.running import check, own_store
from kg.settings import load

if TYPE_CHECKING:
    from pathlib import Path


def codes(folder: Path, question: Question) -> list[str]:
    """Return the reported findings of the store in a folder, as code and system."""
    with read(folder) as snapshot:
        checked = check(snapshot, question, load(folder=folder), folder)
    return [f"{one.code} {one.system.rpartition('/')[2]}" for one in checked.report.findings]


def test_all_systems_of_a_store(robot: Path) -> None:
    """Findings allowed by a comment, and those that assume an included file to be complete, are omitted."""
    assert codes(robot, Question()) == ["KG412 all.launch", "KG401 base.launch", "KG407 sim.launch"]
    assert len(codes(robot, Question(every=True))) == 4


@pytest.mark.parametrize(
    "launch",
    [
        "rover/bringup/launch/base.launch",
        "./rover/bringup/launch/../launch/base.launch",
        "bringup/launch/base.launch",
        "bringup base.launch",
        "base.launch",
    ],
)
def test_one_launch_file(robot: Path, launch: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is named by its path, here or in its source, or by package and file; all of its findings are reported."""
    monkeypatch.chdir(robot)
    assert codes(robot, Question(launch=launch)) == ["KG401 base.launch", "KG407 base.launch"]


def test_a_launch_file_that_is_not_there(robot: Path) -> None:
    """An unknown launch file is reported with similar names."""
    with pytest.raises(
        UnknownNameError, match=r"KG422: the store has no launch file `bringup/launch/bas.launch`"
    ) as caught:
        codes(robot, Question(launch="bringup/launch/bas.launch"))
    assert "`bringup/launch/base.launch`" in (caught.value.hint or "")


def test_a_code_that_no_finding_can_have(robot: Path) -> None:
    """A misspelt code is an error, not an empty report; codes of own rules are taken as they are."""
    with pytest.raises(UnknownNameError, match="KG001: unknown code `KG491`"):
        codes(robot, Question(codes=("KG491",)))
    assert codes(robot, Question(codes=("OWN1",))) == []
    assert codes(robot, Question(codes=("KG401",))) == ["KG401 base.launch"]


def test_the_launch_files_of_a_package(robot: Path) -> None:
    """The package may have its source as prefix."""
    assert len(codes(robot, Question(package="bringup"))) == 4
    assert len(codes(robot, Question(package="local/rover:bringup"))) == 4
    assert codes(robot, Question(package="other:bringup")) == []


def test_folders_have_a_store_of_their_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is in the user's cache, one for each set of folders, in any order."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    one, other = tmp_path / "one", tmp_path / "other"
    place = own_store([one])
    assert place.parent == tmp_path / "cache" / "kg" / "lint"
    assert place.name.startswith("one-")
    assert own_store([one, other]) == own_store([other, one]) != place
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    assert ".cache" in own_store([one]).parts
