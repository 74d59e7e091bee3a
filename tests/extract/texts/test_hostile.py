"""Hostile or broken files: the other descriptions are found."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from extract.workspaces import reader_of
from hypothesis import given, settings
from hypothesis import strategies as st

from kg.corpus.reading import Reader
from kg.corpus.workspace import Workspace, scan
from kg.extract.package import extract_package
from kg.extract.texts.describing import MOST_OF_ONE, of_launch_files
from kg.extract.texts.prose import LONGEST_TEXT
from kg.extract.texts.sources import Comments, Docstrings
from kg.facts import Description, Location, NodeKind, NodeType, Repository

if TYPE_CHECKING:
    from pathlib import Path

MANIFEST = "<package><name>p</name><description>Moves an arm of six joints</description></package>"
SOURCE = """#include <ros/ros.h>
#include <std_msgs/Empty.h>
int main(int argc, char **argv) { ros::init(argc, argv, "n"); ros::NodeHandle h; h.advertise<std_msgs::Empty>("a", 1); }
"""
CMAKE = "project(p)\nfind_package(catkin)\nadd_executable(arm_node arm_node.cpp)\n"


def descriptions(root: Path, files: dict[str, bytes]) -> tuple[Description, ...]:
    """Return the descriptions of a package with one node `arm_node` and these files; no reader may fail."""
    plain = {"package.xml": MANIFEST, "CMakeLists.txt": CMAKE, "arm_node.cpp": SOURCE}
    for path, content in {**{name: text.encode() for name, text in plain.items()}, **files}.items():
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_bytes(content)
    source = scan(root, Repository("local/p", str(root)))
    facts = extract_package(Reader(Workspace([source]), source, source.packages[0]))
    assert "KG121" not in {problem.code for problem in facts.problems}
    return facts.descriptions


@pytest.mark.parametrize(
    "readme",
    [
        b"\x00\x01\x02 arm_node",
        b"\xff\xfe" + "# Arm\n".encode("utf-16-le"),
        b"caf\xe9 arm_node \xff\xff" * 1000,
        b"> " * 200_000,
        b"[" * 200_000,
        b"* " * 200_000,
        b"a" * 3_000_000,
    ],
    ids=["binary", "utf-16", "latin-1", "quotes", "brackets", "emphasis", "one word"],
)
def test_a_broken_readme_costs_only_itself(tmp_path: Path, readme: bytes) -> None:
    """A README that is binary, in another encoding, nested or endless does not affect the other descriptions."""
    found = descriptions(tmp_path, {"README.md": readme})
    assert "Moves an arm of six joints" in [one.text for one in found]


def test_line_ends_and_marks_are_no_text(tmp_path: Path) -> None:
    """Windows line ends and a byte order mark change neither texts nor lines."""
    source = ("\ufeff// Moves the arm\r\n// to its rest.\r\n\r\n" + SOURCE.replace("\n", "\r\n")).encode()
    readme = b"\xef\xbb\xbf# p\r\n\r\nAn arm that\r\nmoves alone.\r\n"
    found = descriptions(tmp_path, {"arm_node.cpp": source, "README.md": readme})
    told = {(one.text, one.location.path, one.location.line) for one in found}
    assert ("Moves the arm to its rest.", "arm_node.cpp", 1) in told
    assert ("An arm that moves alone.", "README.md", 3) in told


def test_descriptions_are_bounded(tmp_path: Path) -> None:
    """A comment of megabytes gives a bounded number of bounded texts."""
    comment = "\n\n".join(f"// It moves joint {number} " + "and so on " * 150 for number in range(2000))
    found = descriptions(tmp_path, {"arm_node.cpp": (comment + "\n" + SOURCE).encode()})
    assert 0 < len(found) <= MOST_OF_ONE + 1
    assert all(len(one.text) <= LONGEST_TEXT for one in found)


def test_what_is_said_twice_stands_once(tmp_path: Path) -> None:
    """A README that repeats the manifest adds nothing."""
    assert len(descriptions(tmp_path, {"README.md": b"# p\n\nMoves an arm of six joints\n"})) == 1


@pytest.mark.parametrize(
    "piece", ["/*", "//\n", '"', "'", "/**/ ", "class A{", "* @brief\n", "// class A\nclass A{\n", "\\"]
)
def test_hostile_sources_end(piece: str) -> None:
    """C++ and Python with one piece repeated up to the size limit are read."""
    text = piece * (400_000 // len(piece))
    Comments(text)
    Docstrings(text.replace("//", "#").replace("/*", '"""').replace("class A{", "class A:\n"))


@pytest.mark.parametrize("piece", ["<!--", "<!-- a -->", "#\n", "# a\nNode(", "<node ", "Node(package='demo',\n"])
@pytest.mark.parametrize("name", ["a.launch", "a.launch.py"])
def test_hostile_launch_files_end(tmp_path: Path, name: str, piece: str) -> None:
    """Launch files with one piece repeated are read and describe nothing."""
    text = "demo\n" + piece * (400_000 // len(piece))
    reader = reader_of(tmp_path, {name: text})
    node = NodeType("n", NodeKind.EXECUTABLE, "cpp", 1, Location("x.cpp", 1), executable="n")
    assert not list(of_launch_files(reader, reader.package, (node,)))


@settings(max_examples=150)
@given(st.text(alphabet="/*!<\\@ \nab{}\"'#class:Ad", max_size=300))
def test_any_source_is_read(text: str) -> None:
    """Comments of any text are found, with existing lines."""
    cpp, python = Comments(text), Docstrings(text)
    found = [*cpp.header, *cpp.main, *python.header, *python.module]
    found += [one for paragraphs in (*cpp.classes.values(), *python.classes.values()) for one in paragraphs]
    assert all(1 <= one.line <= text.count("\n") + 1 for one in found)
