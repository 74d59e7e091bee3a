from __future__ import annotations

from typing import TYPE_CHECKING

from extract.workspaces import codes, manifest, written

from kg.launch.files import reading
from kg.pipeline.work import read_package

if TYPE_CHECKING:
    from pathlib import Path

    import pytest

    from kg.facts import PackageFacts

FILES: dict[str, str | bytes] = {
    "demo/package.xml": manifest("demo"),
    "demo/msg/A.msg": "bool a\n",
    "demo/launch/a.launch": '<launch><node pkg="demo" type="talk" name="talk"/></launch>',
    "demo/launch/b.launch": "<launch><node",
    "demo/launch/of_eclipse.launch": '<launchConfiguration type="test"><mapEntry key="a"/></launchConfiguration>',
}


def read(root: Path) -> PackageFacts:
    """Return the facts of the package `demo` in these files."""
    workspace = written(root, FILES)
    found = workspace.package("demo")
    assert found is not None
    return read_package(workspace, *workspace.folder(found))


def test_launch_files_are_read_with_their_package(tmp_path: Path) -> None:
    """The starts of launch files, the files read for them, and their problems are facts of the package."""
    facts = read(tmp_path)
    assert [one.path for one in facts.launches] == ["demo/launch/a.launch", "demo/launch/b.launch"]
    assert [node.name for node in facts.launches[0].nodes] == ["talk"]
    assert [problem.path for problem in facts.problems if problem.code == "KG415"] == ["demo/launch/b.launch"]
    assert f"{facts.repository}:demo/launch/a.launch" in dict(facts.inputs)


def test_a_defect_in_the_reader_of_launch_files_costs_only_what_they_start(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It becomes a problem KG121 with the place; the facts of code and definitions remain."""

    def fails(*_: object) -> tuple[()]:
        raise ZeroDivisionError("oops")

    monkeypatch.setattr(reading, "read_launches", fails)
    facts = read(tmp_path)
    assert [code for code, _ in codes(facts.problems)] == ["KG121"]
    assert "ZeroDivisionError: oops (test_work.py:" in facts.problems[0].message
    assert not facts.launches
    assert [definition.name for definition in facts.definitions] == ["A"]
