"""User-defined descriptions of framework calls: `kg extract check`, and `kg build` with them."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Final

import pytest
from extract.workspaces import manifest, written
from repository import ROOT

if TYPE_CHECKING:
    from cli.program import Program

SOURCE: Final = """#include <acme/publishers.hpp>
class A : public rclcpp::Node {
public:
  A() : Node("a") { acme::make_publisher<std_msgs::msg::String>(this, "status", 10); }
};
int main() { rclcpp::spin(std::make_shared<A>()); }
"""
FILES: Final = {
    "src/demo/package.xml": manifest("demo"),
    "src/demo/CMakeLists.txt": "project(demo)\nadd_executable(demo main.cpp)\n",
    "src/demo/main.cpp": SOURCE,
    "src/other/package.xml": manifest("other"),
}


def example() -> tuple[str, str]:
    """Return the name and the text of the file shown in docs/calls.md."""
    page = (ROOT / "docs" / "calls.md").read_text(encoding="utf-8")
    found = re.search(r"```toml\n# (calls/\w+.toml)\n(.*?)```", page, re.DOTALL)
    assert found is not None
    return found[1], found[2]


@pytest.fixture
def workspace(kg: Program) -> Program:
    """The program in a workspace whose node uses a framework unknown to kg."""
    written(kg.folder, FILES)
    return kg


def topics_of(kg: Program) -> list[str]:
    """Return the topics published in the node's code."""
    lines = kg("nodes", "--json").out.splitlines()
    return [one["name"] for line in lines for one in json.loads(line)["publishes"]]


def test_the_example_of_the_manual_is_in_force(workspace: Program) -> None:
    """A file in calls/ gives a node the results of its calls, and each edit of the file triggers a full build."""
    name, text = example()
    assert workspace("build", "src").code == 0
    assert "status" not in topics_of(workspace)
    file = workspace.folder / name
    written(workspace.folder, {name: text})
    assert workspace("extract", "check").code == 0
    assert "2 packages" in workspace("status").out
    done = workspace("build")
    assert (done.code, topics_of(workspace).count("status")) == (0, 1)
    assert json.loads(workspace("build", "--json").out)["sources"][0]["read"] == 0
    file.write_text(text.replace("publishes", "subscribes"))
    assert json.loads(workspace("build", "--json").out)["sources"][0]["read"] == 2
    assert "status" not in topics_of(workspace)


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_the_setting_names_files_for_all_workers(workspace: Program, jobs: str) -> None:
    """Any file can be named, and every reading process has its rows."""
    (workspace.folder / "mine.toml").write_text(example()[1])
    assert workspace("build", "src", "--calls", "mine.toml", "--jobs", jobs).code == 0
    assert "status" in topics_of(workspace)


def test_a_build_ends_at_an_error_in_a_description(workspace: Program) -> None:
    """The error has the code, the place and instructions; the store is unchanged."""
    name, text = example()
    written(workspace.folder, {name: text})
    assert workspace("build", "src").code == 0
    written(workspace.folder, {name: text.replace("publishes", "publshes") + "mark = 1\n"})
    done = workspace("build")
    assert done.code == 3
    assert "error[KG123]: `publshes` is not a column of [[call]]" in done.err
    assert f"{name}:8:1" in done.err
    assert "Did you mean `publishes`? `kg extract check` lists all errors." in done.err
    assert "status" in topics_of(workspace)


def test_check_lists_all_errors(kg: Program) -> None:
    """Each error is shown with its line; the exit code is 1; standard error has the count."""
    (kg.folder / "acme.toml").write_text(
        '[[call]]\nin = ["a"]\nname = "f"\nnodes = 1\n[[class]]\nname = "A"\nis = "x"\n'
    )
    done = kg("extract", "check", "acme.toml")
    assert (done.code, done.err) == (1, "1 file checked: 2 errors\n")
    assert "error[KG123]: `nodes` is not a column of [[call]]\n  --> acme.toml:4:1\n" in done.out
    assert "4 | nodes = 1\n  | ^^^^^\nhelp: Did you mean `node`" in done.out
    listed = [json.loads(line) for line in kg("extract", "check", "acme.toml", "--json").out.splitlines()]
    assert [(one["code"], one["file"], one["line"], one["column"]) for one in listed] == [
        ("KG123", "acme.toml", 4, 1),
        ("KG123", "acme.toml", 7, 6),
    ]


def test_check_without_errors(kg: Program) -> None:
    """Without arguments, the files of the setting are checked; without any, the check passes."""
    done = kg("extract", "check")
    assert (done.code, done.out, done.err) == (0, "", "0 files checked: nothing wrong\n")
    written(kg.folder, dict([example()]))
    assert kg("extract", "check").err == "1 file checked: nothing wrong\n"


def test_check_of_a_file_that_cannot_be_read(kg: Program) -> None:
    """A missing or non-text file is an error with its name."""
    done = kg("extract", "check", "none.toml")
    assert (done.code, "error[KG110]" in done.err, "none.toml" in done.err) == (3, True, True)
    (kg.folder / "bad.toml").write_bytes(b"\xff\xfe")
    assert "error[KG110]" in kg("extract", "check", "bad.toml").err
    done = kg("extract", "check", "--calls", "nowhere")
    assert (done.code, "error[KG002]: --calls names" in done.err) == (2, True)
