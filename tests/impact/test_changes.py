"""Effects of changes in the work tree since a commit: `kg impact --diff`."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from typer.testing import CliRunner

from kg.cli.app import app
from kg.pipeline.build import build
from kg.settings import load
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from typer.testing import Result

HERE = Path(__file__).parent
HOIST = "crane/crane/hoist.py"
LAUNCH = "crane/launch/hoist.launch.xml"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a checkout of the workspace with a store, in which several names changed since the commit."""
    root = tmp_path_factory.mktemp("diff") / "harbour"
    shutil.copytree(HERE / "cases" / "workspace", root)
    git(root, "init", "--quiet")
    git(root, "add", ".")
    git(root, "commit", "--quiet", "-m", "one")
    build([str(root)], EmbeddedStore.create(root / ".kg"), load({}, environment={}))
    change(root / HOIST, ('"lift"', '"raise"'), ('"limit", 100', '"heaviest", 100'), ("message.mass", "message.weight"))
    change(root / LAUNCH, ('name="limit" default', 'name="most" default'), ("(var limit)", "(var most)"))
    change(root / "crane_msgs/msg/Load.msg", ("mass", "weight"))
    change(root / "crane/config/hoist.yaml", ("/crane/status", "/crane/state"))
    return root


def git(root: Path, *words: str) -> None:
    """Run git without the user's configuration."""
    who = ("-c", "user.name=a", "-c", "user.email=a@b.c", "-c", "commit.gpgsign=false")
    subprocess.run(["git", *who, *words], cwd=root, check=True, capture_output=True)


def change(path: Path, *pairs: tuple[str, str]) -> None:
    """Replace texts of a file, each of which must occur."""
    text = path.read_text()
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text)


def run(folder: Path, *words: str) -> Result:
    """Run the command on the store of the checkout."""
    return CliRunner().invoke(app, ["--store", str(folder / ".kg"), "impact", "-C", str(folder), *words])


@pytest.fixture(scope="module")
def changes(folder: Path) -> dict[str, Any]:
    """Return the changes by their texts."""
    done = run(folder, "--diff", "HEAD", "--json")
    assert done.exit_code == 0, done.output
    found = [json.loads(line) for line in done.stdout.splitlines()]
    return {one["change"]: one for one in found}


def effects(changed: dict[str, Any]) -> list[tuple[str, str, str, int]]:
    """Return the effects of a change: grade, subject, and line."""
    return [(one["grade"], one["what"], one["file"], one["line"]) for one in changed["effects"]]


def test_a_name_in_code_that_changed_costs_its_partner(changes: dict[str, Any]) -> None:
    """The client of the service has no server."""
    found = changes["~ offers service lift -> raise of crane/hoist"]
    assert (found["file"], found["line"]) == (HOIST, 16)
    assert effects(found) == [("breaks", "/panel calls /lift", "crane/crane/panel.py", 13)]


def test_a_name_in_a_parameter_file_that_changed_costs_its_partner(changes: dict[str, Any]) -> None:
    """The cause is the line of the parameter file."""
    found = changes["~ publishes /crane/status -> /crane/state of /hoist"]
    assert (found["file"], found["line"]) == ("crane/config/hoist.yaml", 3)
    assert effects(found) == [("breaks", "/panel subscribes to /crane/status", "crane/crane/panel.py", 12)]


def test_a_renamed_parameter_is_still_set_by_its_old_name(changes: dict[str, Any]) -> None:
    """It is found even on a line that changed for another reason."""
    found = changes["- parameter limit (double = 100.0) of crane/hoist"]
    assert effects(found) == [("breaks", "sets limit of hoist", LAUNCH, 5)]


def test_a_renamed_argument_is_still_passed_by_its_old_name(changes: dict[str, Any]) -> None:
    """The argument is passed by a file that includes the launch file."""
    found = changes[f"- argument limit (80.0) in {LAUNCH}"]
    assert effects(found) == [
        ("breaks", "crane/launch/crane.launch.xml passes limit", "crane/launch/crane.launch.xml", 4)
    ]


def test_a_field_may_be_used_where_its_line_is_as_it_was(changes: dict[str, Any]) -> None:
    """The use in the hoist changed with the field, that in the panel did not."""
    uses = [one for one in effects(changes["- field crane_msgs/Load.mass"]) if one[1].startswith("`")]
    assert uses == [("may", '`self.get_logger().info(f"{message.load.mass} kg")`', "crane/crane/panel.py", 16)]


def test_the_store_stays_as_it_is(folder: Path, changes: dict[str, Any]) -> None:
    """Data read for the comparison is removed with it."""
    assert changes
    assert not list((folder / ".kg").glob("impact-*"))
    assert run(folder, "lift", "--kind", "service").exit_code == 0


def test_exit_code_markdown_and_what_cannot_be_asked(folder: Path) -> None:
    """A name and a commit exclude each other; an unknown commit is KG104."""
    done = run(folder, "--diff", "HEAD", "--markdown", "--exit-code")
    assert done.exit_code == 1
    assert done.stdout.startswith("### `HEAD..work tree`\n\n**")
    assert "| breaks | `/panel calls /lift` |" in done.stdout
    assert run(folder).exit_code == run(folder, "lift", "--diff", "HEAD").exit_code == 2
    assert run(folder, "--diff", "nowhere").exit_code != 0
