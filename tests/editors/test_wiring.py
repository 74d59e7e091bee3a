"""The findings of `kg lint` in an editor: launch files and code of a workspace with a store."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest
from cli.program import Program
from editors.client import editing

pytest.importorskip("pygls", reason="the extra `lsp` is not installed")

CASE = Path(__file__).parents[1] / "lint" / "cases" / "watcher"
LAUNCH = """\
<launch>
  <node pkg="watch" type="camera.py" name="camera"/>
  <node pkg="watch" type="viewer.py" name="viewer">
    <remap from="image" to="images_raw"/>
  </node>
</launch>
"""


def build(folder: Path) -> None:
    """Build the store of a workspace like its owner."""
    run = Program(folder)("build", "src")
    assert run.code == 0, run.err


@pytest.fixture(name="folder", scope="module")
def make_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a workspace with a store, whose launch file misspells a topic."""
    folder = tmp_path_factory.mktemp("workspace")
    shutil.copytree(CASE, folder / "src")
    (folder / "src/watch/launch/watch.launch").write_text(LAUNCH)
    build(folder)
    return folder


@pytest.fixture(name="workspace")
def make_workspace(folder: Path, tmp_path: Path) -> Path:
    """Return a copy of the workspace for a modifying test, in a folder with a space in its name."""
    target = tmp_path / "my robot"
    shutil.copytree(folder, target)
    return target


def codes(found: list[dict[str, Any]]) -> list[str]:
    """Return the codes of diagnostics."""
    return [each["code"] for each in found]


def test_a_misspelt_topic(folder: Path) -> None:
    """The name is marked, its code links to the documentation, and related lines are listed."""
    file = folder / "src/watch/launch/watch.launch"
    with editing(folder) as editor:
        (found,) = editor.diagnostics(file)
    assert (found["code"], found["severity"], found["source"]) == ("KG401", 2, "kg")
    assert found["range"] == {"start": {"line": 3, "character": 28}, "end": {"line": 3, "character": 38}}
    assert "/image_raw is published" in found["message"]
    page, _, line = found["codeDescription"]["href"].removeprefix("file://").partition("#L")
    assert Path(page).read_text().splitlines()[int(line) - 1].startswith("### KG401")
    related = {each["location"]["uri"].rpartition("/")[2]: each["message"] for each in found["relatedInformation"]}
    assert related["camera.py"] == "publishes image_raw"


def test_a_fix_and_a_save(workspace: Path) -> None:
    """The quick fix corrects the name; on saving, the source is built again and the finding disappears."""
    build(workspace)  # the store names its original folder
    file = workspace / "src/watch/launch/watch.launch"
    with editing(workspace) as editor:
        editor.open(file)
        (found,) = editor.diagnostics(file, until=bool)
        fixes = editor.fixes(file, found)
        assert list(fixes) == [
            "Replace `images_raw` by `image_raw`",
            "Replace `image_raw` by `images_raw` in camera.py:6",
        ]
        texts, _ = editor.applied(next(iter(fixes.values())))
        assert texts == {file: LAUNCH.replace("images_raw", "image_raw")}
        editor.edit(file, texts[file])
        editor.save(file)
        assert editor.diagnostics(file) == []


def test_a_fix_of_a_text_that_changed(folder: Path) -> None:
    """A quick fix is offered only while its text is unchanged in place."""
    file = folder / "src/watch/launch/watch.launch"
    with editing(folder) as editor:
        editor.open(file)
        (found,) = editor.diagnostics(file, until=bool)
        editor.edit(file, LAUNCH.replace("images_raw", "image_xy"))
        assert list(editor.fixes(file, found)) == ["Replace `image_raw` by `images_raw` in camera.py:6"]


def test_a_build_elsewhere(workspace: Path) -> None:
    """When the store changes, the findings are read again."""
    build(workspace)
    file = workspace / "src/watch/launch/watch.launch"
    with editing(workspace) as editor:
        assert codes(editor.diagnostics(file)) == ["KG401"]
        file.write_text(LAUNCH.replace("images_raw", "image_raw"))
        build(workspace)
        change = {"uri": (workspace / ".kg/current").as_uri(), "type": 2}
        editor.notify("workspace/didChangeWatchedFiles", changes=[change])
        assert editor.diagnostics(file) == []


def test_no_build_is_wanted(workspace: Path) -> None:
    """With the option `build` off, saving reads the findings of the existing store."""
    build(workspace)
    file = workspace / "src/watch/launch/watch.launch"
    with editing(workspace, options={"build": False}) as editor:
        editor.open(file)
        editor.diagnostics(file, until=bool)
        editor.edit(file, LAUNCH.replace("images_raw", "image_raw"))
        editor.save(file)
        assert codes(editor.diagnostics(file)) == ["KG401"]


def test_unusable_settings(folder: Path, tmp_path: Path) -> None:
    """An error in kg.toml is shown, and rules are still served."""
    (tmp_path / "kg.toml").write_text("[[lint.allow]]\ncode = 'KG401'\n")
    shutil.copytree(folder / ".kg", tmp_path / ".kg")
    rule = tmp_path / "rules" / "mine" / "one.rq"
    with editing(tmp_path) as editor:
        editor.open(rule, "CONSTRUCT { ?a a ?b } WERE { ?a a ?b }")
        assert codes(editor.diagnostics(rule)) == ["KG201"]
        shown = editor.message("window/showMessage")
    assert "the entry for KG401 has no reason" in shown["message"]


def test_no_store(tmp_path: Path) -> None:
    """Without a store no diagnostics of launch files are published, and no message is shown."""
    file = tmp_path / "a.launch"
    rule = tmp_path / "rules" / "mine" / "one.rq"
    file.write_text(LAUNCH)
    with editing(tmp_path) as editor:
        editor.open(file)
        editor.save(file)
        editor.open(rule, "CONSTRUCT { ?a a ?b } WERE { ?a a ?b }")
        assert codes(editor.diagnostics(rule)) == ["KG201"]
        assert not [each for each in editor.read if each.get("method") == "window/showMessage"]


def test_what_a_line_of_code_creates(folder: Path) -> None:
    """The name and type of the interface of a line are shown, and who is at the other side."""
    camera, viewer = folder / "src/watch/scripts/camera.py", folder / "src/watch/scripts/viewer.py"
    with editing(folder) as editor:
        editor.open(camera)
        words = editor.at("hover", camera, "pictures = ")["contents"]["value"]
        assert words.startswith("watch/camera **publishes** `/image_raw` `sensor_msgs/Image`")
        assert editor.at("hover", camera, "rospy.spin") is None
        assert editor.at("references", camera, "pictures = ", context={"includeDeclaration": False}) == []
        (own,) = editor.at("references", camera, "pictures = ", context={"includeDeclaration": True})
        assert (own["uri"], own["range"]["start"]["line"]) == (camera.as_uri(), 5)
        editor.open(viewer)
        assert "`/images_raw`" in editor.at("hover", viewer, "rospy.Subscriber")["contents"]["value"]


def test_what_is_connected_to_a_line_of_code(workspace: Path) -> None:
    """The lines at the other side are listed with their launch file, and can be jumped to."""
    (workspace / "src/watch/launch/watch.launch").write_text(LAUNCH.replace("images_raw", "image_raw"))
    build(workspace)
    camera, viewer = workspace / "src/watch/scripts/camera.py", workspace / "src/watch/scripts/viewer.py"
    with editing(workspace) as editor:
        editor.open(camera)
        words = editor.at("hover", camera, "pictures = ")["contents"]["value"]
        assert (
            f"- `/viewer` subscribes in `watch/launch/watch.launch`: [watch/scripts/viewer.py:6]({viewer.as_uri()}#L6)"
            in words
        )
        (place,) = editor.at("references", camera, "pictures = ", context={"includeDeclaration": False})
        assert (place["uri"], place["range"]["start"]["line"]) == (viewer.as_uri(), 5)


def test_what_a_line_of_a_launch_file_starts(folder: Path) -> None:
    """The node is shown, and its definition is its code."""
    file = folder / "src/watch/launch/watch.launch"
    with editing(folder) as editor:
        editor.open(file)
        assert "**starts** `/camera`, `watch/camera`" in editor.at("hover", file, "<node pkg")["contents"]["value"]
        (place,) = editor.at("definition", file, "<node pkg")
        assert place["uri"] == (folder / "src/watch/scripts/camera.py").as_uri()
        assert editor.at("hover", file, "<remap") is None
