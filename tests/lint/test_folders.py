"""Integration: a folder is read, rules run, and the findings are reported."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from lint.robot import HERE
from typer.testing import CliRunner

import kg
from kg.cli.app import app
from kg.errors import StoreError
from kg.lint.question import Question
from kg.lint.running import check_store, own_store, read_folders
from kg.settings import load
from kg.store.embedded import EmbeddedStore


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a copy of a small workspace."""
    folder = tmp_path_factory.mktemp("folders") / "src"
    shutil.copytree(HERE / "cases" / "watcher", folder)
    return folder


@pytest.fixture(autouse=True)
def cache(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the cache of these tests, which start outside of any store."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder.parent / "cache"))
    monkeypatch.chdir(folder.parent)
    return folder.parent / "cache"


def test_a_folder_is_checked_without_a_trace(folder: Path, cache: Path) -> None:
    """The store is in the cache, the folder is unchanged, and the finding has its lines."""
    before = sorted(folder.rglob("*"))
    (found,) = kg.findings([folder], level="warning")
    assert (found["code"], found["file"], found["line"]) == ("KG401", "watch/launch/watch.launch", 5)
    assert found["subjects"] == ["/images_raw", "/camera", "/image_raw", "/viewer"]
    assert {(one["file"], one["line"]) for one in found["evidence"]} >= {
        ("watch/scripts/camera.py", 6),
        ("watch/scripts/viewer.py", 6),
    }
    assert sorted(folder.rglob("*")) == before
    assert own_store([folder]).is_relative_to(cache)


def test_the_second_check_reads_nothing(folder: Path) -> None:
    """Only changes are read."""
    read_folders([folder], load())
    _, report = read_folders([folder], load())
    assert report.read == 0


def test_a_second_check_at_the_same_time_waits(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It waits for a limited time; then it names the running process."""
    monkeypatch.setattr("kg.lint.running._PATIENCE", 0.1)
    monkeypatch.setattr("kg.lint.running._PAUSE", 0.01)
    busy = EmbeddedStore.create(own_store([folder]))
    with busy.write("kg lint"), pytest.raises(StoreError, match="KG302"):
        read_folders([folder], load())


def test_another_argument_is_another_system(folder: Path) -> None:
    """The launch file is evaluated again, without a change of the store."""
    given, _ = read_folders([folder], load())
    question = Question(launch="watch.launch", level="warning")
    mended = Question(launch="watch.launch", level="warning", arguments={"topic": "image_raw"})
    assert [len(check_store(given, one, folder).report.findings) for one in (question, mended, question)] == [1, 0, 1]


def test_the_folder_of_the_sources_has_the_allow_list(folder: Path) -> None:
    """The kg.toml in the folder is used."""
    text = '[[lint.allow]]\ncode = "KG401"\nsubject = "/images_raw"\nreason = "a test"\n'
    (folder / "kg.toml").write_text(text, encoding="utf-8")
    try:
        assert kg.findings([folder], level="warning") == []
    finally:
        (folder / "kg.toml").unlink()


def test_the_command_reads_folders_without_a_word(folder: Path) -> None:
    """Without a terminal only findings and their sum are written; notes name files relative to the working folder."""
    result = CliRunner().invoke(app, ["lint", str(folder), "--format", "github", "--level", "warning"])
    assert result.exit_code == 1
    assert result.stdout.startswith("::warning file=src/watch/launch/watch.launch,line=5,col=1,title=KG401::")
    assert result.stderr == "1 system checked: 1 warning\n"


def test_a_hook_runs_a_command_that_there_is() -> None:
    """The hook for pre-commit calls `kg lint`."""
    hooks = (Path(kg.__file__).parents[1] / ".pre-commit-hooks.yaml").read_text(encoding="utf-8")
    assert "entry: kg lint .\n" in hooks
    assert "pass_filenames: false\n" in hooks


def test_launch_files_of_one_name_are_told_apart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Findings name the launch file by an unambiguous text accepted by `--launch`."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    folders = [tmp_path / name for name in ("old", "new")]
    for folder in folders:
        shutil.copytree(HERE / "cases" / "systems" / "undeclared_argument" / "zones", folder / "zones")
    found = kg.findings(folders)
    assert len({one["system"] for one in found}) == len(found) == 2
    settings, _ = read_folders(folders, load())
    for one in found:
        checked = check_store(settings, Question(launch=one["system"]), tmp_path)
        assert [(other.system, other.place and other.place.repository) for other in checked.report.findings] == [
            (one["system"], one["repository"])
        ]
