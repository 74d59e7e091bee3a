from __future__ import annotations

import json
import subprocess
from typing import TYPE_CHECKING

import pytest
from cli.program import Program

if TYPE_CHECKING:
    from pathlib import Path

    from cli.program import Run

MANIFEST = """<package format="2"><name>demo</name><version>0.0.1</version><description>d</description>
<maintainer email="a@b.c">a</maintainer><license>MIT</license><buildtool_depend>catkin</buildtool_depend></package>
"""
CMAKE = "project(demo)\nfind_package(catkin)\ncatkin_package()\n"
TALKER = """#!/usr/bin/env python
import rospy
from std_msgs.msg import String
rospy.init_node("talker")
publisher = rospy.Publisher("chatter", String, queue_size=1)
rospy.Subscriber("reply", String, print)
"""
LISTENER = """#!/usr/bin/env python
import rospy
from std_msgs.msg import String
rospy.init_node("listener")
rospy.Subscriber("chatter", String, print)
"""
LAUNCH = """<launch>
  <node pkg="demo" type="talker.py" name="talker"/>
  <node pkg="demo" type="listener.py" name="listener"/>
</launch>
"""
REMAPPED = LAUNCH.replace('name="listener"/>', 'name="listener"><remap from="chatter" to="chat"/></node>')


def git(folder: Path, *words: str) -> str:
    """Run git without the user's configuration."""
    who = ("-c", "user.name=a", "-c", "user.email=a@b.c", "-c", "commit.gpgsign=false", "-c", "init.defaultBranch=main")
    done = subprocess.run(["git", *who, *words], cwd=folder, check=True, capture_output=True, text=True)
    return done.stdout


@pytest.fixture(scope="module")
def repository(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a repository with two commits: the second remaps a topic, and the talker subscribes to another one."""
    root = tmp_path_factory.mktemp("demo")
    texts = {"package.xml": MANIFEST, "CMakeLists.txt": CMAKE, "talker.py": TALKER, "listener.py": LISTENER}
    for name, text in {**texts, "both.launch": LAUNCH}.items():
        (root / name).write_text(text)
        (root / name).chmod(0o755 if name.endswith(".py") else 0o644)
    git(root, "init", "--quiet")
    git(root, "add", ".")
    git(root, "commit", "--quiet", "-m", "one")
    (root / "both.launch").write_text(REMAPPED)
    (root / "talker.py").write_text(TALKER.replace("reply", "answer"))
    git(root, "commit", "--quiet", "-a", "-m", "two")
    return root


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return an empty user cache."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(scope="module")
def compared(repository: Path, cache: Path) -> Run:
    """Return the output of `kg diff` for both commits, which fills the cache."""
    return diff(repository, cache, "HEAD~1..HEAD")


@pytest.fixture(scope="module")
def stored(repository: Path, cache: Path, compared: Run, tmp_path_factory: pytest.TempPathFactory) -> Program:
    """Return the program in a folder with a store of the second commit."""
    assert compared.code == 0, compared.err
    folder = tmp_path_factory.mktemp("stored")
    (folder / ".kg").symlink_to(store_of(repository, cache, "HEAD"))
    return Program(folder)


def store_of(repository: Path, cache: Path, commit: str) -> Path:
    """Return a cached store of a commit."""
    return next(cache.glob(f"kg/revisions/{git(repository, 'rev-parse', commit).strip()}-*"))


def diff(repository: Path, cache: Path, *arguments: str) -> Run:
    """Compare in the repository."""
    return Program(repository)("diff", *arguments, XDG_CACHE_HOME=str(cache), KG_JOBS="1")


def test_graph_lists_each_end_with_who_is_at_the_other_side(stored: Program) -> None:
    """Without a terminal the output is a table; the only launch file need not be named."""
    run = stored("graph")
    assert run.code == 0
    assert "/talker\tpublishes\t/chatter\tstd_msgs/String\t(nobody subscribes)" in run.out.splitlines()
    assert "/listener\tsubscribes\t/chat\tstd_msgs/String\t(nobody publishes)" in run.out.splitlines()


def test_unknown_includes_are_reported(tmp_path: Path) -> None:
    """`kg graph` and `kg lint` name the parts of a launch file whose nodes are missing."""
    (tmp_path / "package.xml").write_text(MANIFEST)
    (tmp_path / "CMakeLists.txt").write_text(CMAKE)
    for name, text in {"talker.py": TALKER, "listener.py": LISTENER}.items():
        (tmp_path / name).write_text(text)
        (tmp_path / name).chmod(0o755)
    nowhere = '<include file="$(find elsewhere)/launch/x.launch"/>'
    foreign = '<node pkg="elsewhere" type="x" name="x"/>'
    (tmp_path / "outer.launch").write_text(LAUNCH.replace("</launch>", f"  {nowhere}\n  {foreign}\n</launch>"))
    program = Program(tmp_path)
    assert program("build", ".").code == 0
    words = "note: outer.launch:4: the package 'elsewhere' is neither in the build nor installed; nodes may be missing"
    drawn = program("graph")
    assert words in drawn.err
    assert "note: 1 node with unknown topics may be where `nobody` is: /x" in drawn.err
    assert words in program("lint", "--launch", "outer.launch").err
    assert "may be missing" not in program("lint").err


def test_depth_limits_the_distance_from_the_focus(stored: Program) -> None:
    """`--depth` is a whole number of at least 0."""
    near = json.loads(stored("graph", "--json", "--focus", "talker", "--depth", "0").out)
    assert [one["id"] for one in near["nodes"]] == ["/talker"]
    wrong = stored("graph", "--focus", "talker", "--depth", "near")
    assert wrong.code == 2
    assert "`--depth near`" in wrong.err


def test_graph_writes_the_form_that_is_asked_for(stored: Program) -> None:
    """The format is given by a flag, or by the suffix of the file."""
    assert stored("graph", "--dot").out.startswith("digraph ")
    assert stored("graph", "--launch", "both.launch", "--mermaid").out.startswith("flowchart LR")
    assert [one["id"] for one in json.loads(stored("graph", "--json", "--focus", "talker").out)["nodes"]] == ["/talker"]
    assert stored("graph", "-o", "x.svg").err.endswith("wrote x.svg\n")
    assert (stored.folder / "x.svg").read_text().startswith("<svg ")


def test_graph_knows_what_was_meant(stored: Program) -> None:
    """A missing node, two formats at once and an unknown suffix are rejected with instructions."""
    wrong = stored("graph", "--focus", "takler")
    assert (wrong.code, "KG001" in wrong.err, "/talker" in wrong.err) == (1, True, True)
    assert "KG003" in stored("graph", "--svg", "--dot").err
    assert "KG003" in stored("graph", "-o", "x.pdf").err


def test_diff_tells_what_changed_between_commits(repository: Path, cache: Path, compared: Run) -> None:
    """Changed interfaces and wiring are listed as text and as JSON; work tree and repository are unchanged."""
    lines = [" ".join(line.split()) for line in compared.out.splitlines()]
    assert "~ subscribes reply -> answer talker.py:6" in lines
    assert "~ subscribes /chatter -> /chat both.launch:3" in lines
    assert "- /talker to /listener by topic /chatter" in lines
    assert not git(repository, "status", "--porcelain", "--ignored")
    assert len(git(repository, "worktree", "list").splitlines()) == 1
    again = diff(repository, cache, "HEAD~1", "HEAD", "--json", "--exit-code")
    assert again.code == 1
    assert {"connection", "end", "interface"} <= {json.loads(line)["level"] for line in again.out.splitlines()}


def test_diff_writes_markdown_and_a_picture(repository: Path, cache: Path) -> None:
    """A pull request gets a table, and a graph of the affected nodes."""
    text = diff(repository, cache, "HEAD~1..HEAD", "--markdown").out
    assert text.startswith("### `HEAD~1..HEAD`\n\n**")
    assert "| ~ | `subscribes /chatter -> /chat` |" in text
    picture = diff(repository, cache, "HEAD~1..HEAD", "--svg").out
    assert "~ /listener" in picture
    assert "- → /chatter" not in picture


def test_equal_sides_have_no_differences(repository: Path, cache: Path) -> None:
    """Three dots compare with the merge base; without differences the exit code is always 0."""
    same = diff(repository, cache, "HEAD...HEAD", "--exit-code")
    assert (same.code, same.out) == (0, "no differences\n")


def test_diff_compares_stores(repository: Path, cache: Path, stored: Program) -> None:
    """Two folders are compared as two stores."""
    run = stored("diff", str(store_of(repository, cache, "HEAD~1")), ".kg")
    assert "- /talker to /listener by topic /chatter" in run.out


def test_diff_compares_two_launch_files_of_a_store(tmp_path: Path) -> None:
    """What one launch file starts is compared with another one, whose name must be unique in the store."""
    texts = {"package.xml": MANIFEST, "CMakeLists.txt": CMAKE, "talker.py": TALKER, "listener.py": LISTENER}
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
        (tmp_path / name).chmod(0o755 if name.endswith(".py") else 0o644)
    (tmp_path / "both.launch").write_text(LAUNCH)
    (tmp_path / "apart.launch").write_text(REMAPPED)
    program = Program(tmp_path)
    assert program("build", ".", "--store", "store").code == 0
    run = program("diff", "--launch", "both.launch", "--with", "apart.launch", "--store", "store")
    assert "- /talker to /listener by topic /chatter" in run.out
    same = program("diff", "--launch", "both.launch", "--with", "both.launch", "--store", "store", "--exit-code")
    assert (same.code, same.out) == (0, "no differences\n")
    assert "KG422" in program("diff", "--launch", "both.launch", "--with", "none.launch", "--store", "store").err
    assert "KG003" in program("diff", "--with", "both.launch", "--store", "store").err


def test_diff_names_what_it_cannot_compare(repository: Path, cache: Path, tmp_path: Path) -> None:
    """An unknown commit, a shallow clone, a folder without git and a single side are rejected."""
    unknown = diff(repository, cache, "nowhere..HEAD")
    assert (unknown.code, "KG104" in unknown.err, "nowhere" in unknown.err) == (3, True, True)
    assert "KG101" in diff(tmp_path, cache, "a..b").err
    assert "KG003" in diff(repository, cache, "HEAD").err
    git(tmp_path, "clone", "--quiet", "--depth", "1", f"file://{repository}", "shallow")
    shallow = diff(tmp_path / "shallow", cache, "HEAD~1..HEAD")
    assert "unshallow" in shallow.err
    assert "KG104" in diff(repository, cache, "--", "--output=x..HEAD").err, "a name never becomes an option of git"


def test_a_broken_launch_file_is_no_empty_graph(tmp_path: Path) -> None:
    """The build lists it as a problem; `kg graph` reports the place and the fix, and exits with 1."""
    launch = tmp_path / "ws" / "demo" / "launch" / "bad.launch"
    launch.parent.mkdir(parents=True)
    (tmp_path / "ws" / "demo" / "package.xml").write_text(MANIFEST)
    launch.write_text('<launch>\n  <node pkg="a"')
    program = Program(tmp_path)
    built = program("build", "ws", "--store", "store")
    assert built.code == 0
    assert "problems 1 in 1 file; the rest was built:" in built.err
    assert "  ws/demo/launch/bad.launch:2: KG415 the file is not well-formed XML" in built.err
    drawn = program("graph", "bad.launch", "--store", "store")
    assert drawn.code == 1
    assert "error[KG415]: the file is not well-formed XML" in drawn.err
    assert "--> ws/demo/launch/bad.launch:2" in drawn.err
    assert "help: Correct the syntax" in drawn.err
    assert "starts no nodes" not in drawn.err


def test_nodes_outside_of_the_build_may_be_at_the_other_side(tmp_path: Path) -> None:
    """A note names the nodes whose topics are unknown: they may be the ends that the graph lacks."""
    launch = tmp_path / "ws" / "demo" / "launch" / "driver.launch"
    launch.parent.mkdir(parents=True)
    (tmp_path / "ws" / "demo" / "package.xml").write_text(MANIFEST)
    launch.write_text('<launch>\n  <node pkg="elsewhere" type="driver" name="driver"/>\n</launch>')
    program = Program(tmp_path)
    program("build", "ws", "--store", "store")
    drawn = program("graph", "driver.launch", "--store", "store")
    assert drawn.code == 0
    assert "note: 1 node with unknown topics may be where `nobody` is: /driver (`kg instances " in drawn.err
