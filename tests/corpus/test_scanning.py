from __future__ import annotations

import os
import subprocess
from typing import TYPE_CHECKING

import pytest
from extract.workspaces import manifest

from kg.corpus.scanning import scan, scan_tree
from kg.errors import SourceError
from kg.facts import FileKind, Repository

if TYPE_CHECKING:
    from pathlib import Path

    from kg.corpus.files import Source


def package(root: Path, path: str, name: str | None = None) -> Path:
    """Write a package with one source file and return its folder."""
    folder = root / path
    (folder / "src").mkdir(parents=True)
    (folder / "package.xml").write_text(manifest(name or folder.name))
    (folder / "src" / "node.cpp").write_text("int main() {}\n")
    return folder


def paths(source: Source, name: str) -> list[str]:
    """Return the paths of a package's files."""
    return [entry.path for found in source.packages if found.name == name for entry in found.files]


def codes(source: Source) -> list[tuple[str, str]]:
    """Return code and path of each problem."""
    return [(problem.code, problem.path) for problem in source.problems]


def test_packages_own_their_files(tmp_path: Path) -> None:
    """Each file belongs to the innermost package above it; files above all packages are loose."""
    package(tmp_path, "outer")
    package(tmp_path, "outer/inner")
    (tmp_path / "README.md").write_text("x")
    source = scan(tmp_path)
    assert paths(source, "outer") == ["outer/package.xml", "outer/src/node.cpp"]
    assert paths(source, "inner") == ["outer/inner/package.xml", "outer/inner/src/node.cpp"]
    assert [entry.path for entry in source.loose] == ["README.md"]
    assert source.problems == ()


def test_launch_files_outside_of_packages_have_one_of_their_own(tmp_path: Path) -> None:
    """They are started by their path; pages next to them stay loose."""
    package(tmp_path, "robot")
    (tmp_path / "launch").mkdir()
    (tmp_path / "launch" / "all.launch").write_text("<launch/>")
    (tmp_path / "README.md").write_text("x")
    source = scan(tmp_path)
    assert [(found.name, found.path, found.manifest) for found in source.packages] == [
        (tmp_path.name, ".", None),
        ("robot", "robot", "robot/package.xml"),
    ]
    assert paths(source, tmp_path.name) == ["launch/all.launch"]
    assert [entry.path for entry in source.loose] == ["README.md"]


def test_a_package_of_launch_files_has_a_name_of_its_own(tmp_path: Path) -> None:
    """The folder may be called like one of its packages."""
    package(tmp_path / "robot", "robot")
    (tmp_path / "robot" / "all.launch").write_text("<launch/>")
    assert [found.name for found in scan(tmp_path / "robot").packages] == ["robot-root", "robot"]


def test_name_comes_from_the_manifest(tmp_path: Path) -> None:
    """A package is named by its package.xml, not by its folder."""
    package(tmp_path, "folder", "real_name")
    assert [found.name for found in scan(tmp_path).packages] == ["real_name"]


def test_package_in_the_root(tmp_path: Path) -> None:
    """A repository that is one package has it at `.`."""
    package(tmp_path, "repo")
    (found,) = scan(tmp_path / "repo").packages
    assert (found.name, found.path, found.manifest) == ("repo", ".", "package.xml")


@pytest.mark.parametrize("marker", ["COLCON_IGNORE", "CATKIN_IGNORE", "AMENT_IGNORE", "pyvenv.cfg"])
def test_ignore_markers(tmp_path: Path, marker: str) -> None:
    """A folder with an ignore marker is excluded with its subfolders."""
    package(tmp_path, "kept")
    package(tmp_path, "skipped/deeper")
    (tmp_path / "skipped" / marker).touch()
    assert [found.name for found in scan(tmp_path).packages] == ["kept"]


def test_ignore_markers_that_leave_no_package(tmp_path: Path) -> None:
    """Where no package is left, the excluded folders are problems, each with its marker."""
    package(tmp_path, "arms/driver")
    (tmp_path / "arms" / "CATKIN_IGNORE").touch()
    assert [(one.path, one.message.split()[0]) for one in scan(tmp_path).problems if one.path != "."] == [
        ("arms", "CATKIN_IGNORE")
    ]


def test_ignore_marker_inside_a_package(tmp_path: Path) -> None:
    """Inside a package a marker hides nested packages, but not the files of the package."""
    folder = package(tmp_path, "pkg")
    package(tmp_path, "pkg/lessons/nested")
    (folder / "lessons" / "CATKIN_IGNORE").touch()
    (folder / "lessons" / "code.cpp").touch()
    source = scan(tmp_path)
    assert [found.name for found in source.packages] == ["pkg"]
    assert paths(source, "pkg") == ["pkg/lessons/code.cpp", "pkg/package.xml", "pkg/src/node.cpp"]


@pytest.mark.parametrize("folder", ["build", "install", "devel", "log", ".hidden", "node_modules", "x.egg-info"])
def test_what_builds_leave_behind(tmp_path: Path, folder: str) -> None:
    """Build results and hidden folders are not sources."""
    package(tmp_path, "kept")
    package(tmp_path, f"{folder}/copy")
    assert [found.name for found in scan(tmp_path).packages] == ["kept"]


def test_folder_named_log_inside_a_package_is_source(tmp_path: Path) -> None:
    """Inside a package the same names are ordinary folders unless they contain traces of a build."""
    folder = package(tmp_path, "pkg")
    for name in ("log", "build"):
        (folder / name).mkdir()
        (folder / name / "code.cpp").touch()
    (folder / "build" / "CMakeCache.txt").touch()
    assert paths(scan(tmp_path), "pkg") == ["pkg/log/code.cpp", "pkg/package.xml", "pkg/src/node.cpp"]


def test_rosbuild_package(tmp_path: Path) -> None:
    """A folder with a manifest.xml is a package named after the folder."""
    (tmp_path / "old").mkdir()
    (tmp_path / "old" / "manifest.xml").write_text("<package><description>x</description></package>")
    (found,) = scan(tmp_path).packages
    assert (found.name, found.manifest) == ("old", "old/manifest.xml")


def test_duplicate_names(tmp_path: Path) -> None:
    """The deeper of two packages of one name is named after its folder, and reported."""
    package(tmp_path, "deep/er/twin", "twin")
    package(tmp_path, "twin", "twin")
    source = scan(tmp_path)
    assert [(found.name, found.path) for found in source.packages] == [
        ("deep/er/twin", "deep/er/twin"),
        ("twin", "twin"),
    ]
    assert codes(source) == [("KG120", "deep/er/twin/package.xml")]


def test_root_without_manifest_is_one_package(tmp_path: Path) -> None:
    """Loose ROS code is read as one package named after the folder, which is reported."""
    (tmp_path / "loose").mkdir()
    (tmp_path / "loose" / "node.py").write_text("import rospy\n")
    source = scan(tmp_path / "loose")
    assert [(found.name, found.manifest) for found in source.packages] == [("loose", None)]
    assert codes(source) == [("KG102", ".")]
    assert source.loose == ()


def test_folder_without_code(tmp_path: Path) -> None:
    """A folder without readable code yields no package, which is reported."""
    source = scan(tmp_path)
    assert source.packages == ()
    assert codes(source) == [("KG102", ".")]


def test_missing_root(tmp_path: Path) -> None:
    """A missing root is an error of its own, the only one raised by a scan."""
    with pytest.raises(SourceError) as caught:
        scan(tmp_path / "nowhere")
    assert caught.value.code == "KG101"


def test_malformed_manifest_keeps_the_package(tmp_path: Path) -> None:
    """A package with an unreadable manifest is named after its folder."""
    folder = package(tmp_path, "broken")
    (folder / "package.xml").write_bytes(b"\xff\xfe<<<")
    assert [found.name for found in scan(tmp_path).packages] == ["broken"]


def test_executable_bit_and_shebang(tmp_path: Path) -> None:
    """Executables are marked; a program without suffix is Python if its first line names it, and listed otherwise."""
    folder = package(tmp_path, "pkg") / "scripts"
    folder.mkdir()
    (folder / "talker").write_text("#!/usr/bin/env python3\n")
    (folder / "talker").chmod(0o755)
    (folder / "shell").write_text("#!/bin/sh\n")
    for name, content in (("run", b"#!/bin/sh\n"), ("binary", b"\x7fELF\0\0"), ("notes", b"text")):
        (folder / name).write_bytes(content)
        (folder / name).chmod(0o755)
    entries = {entry.path: entry for entry in scan(tmp_path).packages[0].files}
    assert entries["pkg/scripts/talker"].kind is FileKind.PYTHON
    assert entries["pkg/scripts/talker"].executable
    assert not entries["pkg/src/node.cpp"].executable
    assert {path for path in entries if entries[path].kind is FileKind.PROGRAM} == {
        "pkg/scripts/run",
        "pkg/scripts/binary",
    }
    assert not entries.keys() & {"pkg/scripts/shell", "pkg/scripts/notes"}


def test_links(tmp_path: Path) -> None:
    """Links inside the source are read; external, dangling and looping ones are reported and skipped."""
    root = tmp_path / "root"
    folder = package(root, "pkg")
    (tmp_path / "secret.cpp").write_text("// not ours\n")
    (folder / "src" / "same.cpp").symlink_to("node.cpp")
    (folder / "src" / "out.cpp").symlink_to(tmp_path / "secret.cpp")
    (folder / "src" / "gone.cpp").symlink_to("nothing.cpp")
    (folder / "src" / "loop.cpp").symlink_to("loop.cpp")
    (folder / "up").symlink_to(root)
    (folder / "away").symlink_to(tmp_path)
    source = scan(root)
    assert paths(source, "pkg") == ["pkg/package.xml", "pkg/src/node.cpp", "pkg/src/same.cpp"]
    named = [f"pkg/{name}" for name in ("away", "src/gone.cpp", "src/loop.cpp", "src/out.cpp")]
    assert codes(source) == [("KG110", name) for name in named]
    assert source.links == (("pkg/up", "."),)


@pytest.mark.skipif(os.geteuid() == 0, reason="root reads every folder")
def test_unreadable_folder(tmp_path: Path) -> None:
    """An unreadable folder is reported, and the rest is read."""
    folder = package(tmp_path, "pkg")
    (folder / "src").chmod(0)
    source = scan(tmp_path)
    (folder / "src").chmod(0o755)
    assert codes(source) == [("KG110", "pkg/src")]


def test_names_that_are_no_text(tmp_path: Path) -> None:
    """A name that is not UTF-8 is shown escaped and skipped; others in any script are read."""
    folder = package(tmp_path, "pkg")
    (folder / "src" / "узел.cpp").touch()
    with open(os.fsencode(folder / "src") + b"/bad\xff.cpp", "wb"):  # noqa: PTH123  (a Path cannot be made of bytes)
        pass
    source = scan(tmp_path)
    assert "pkg/src/узел.cpp" in paths(source, "pkg")
    assert codes(source) == [("KG110", "pkg/src/bad\\xff.cpp")]


def test_pipes_are_no_files(tmp_path: Path) -> None:
    """Only regular files are opened."""
    folder = package(tmp_path, "pkg")
    os.mkfifo(folder / "src" / "pipe.cpp")
    assert "pkg/src/pipe.cpp" not in paths(scan(tmp_path), "pkg")


def git(folder: Path, *arguments: str) -> None:
    """Run git in a folder, with a name to commit under."""
    identity = ("-c", "user.name=A", "-c", "user.email=a@example.org")
    subprocess.run(("git", "-C", str(folder), *identity, *arguments), check=True, capture_output=True)


def test_checkouts_in_a_workspace_are_sources_of_their_own(tmp_path: Path) -> None:
    """Each repository of a workspace is a source; packages outside any repository belong to the workspace."""
    package(tmp_path, "src/plain")
    package(tmp_path, "src/robot/base")
    git(tmp_path / "src" / "robot", "init", "--quiet")
    git(tmp_path / "src" / "robot", "remote", "add", "origin", "git@example.org:acme/robot.git")
    sources = scan_tree(tmp_path / "src")
    names = [(source.repository.name, [found.name for found in source.packages]) for source in sources]
    assert names == [("local/src", ["plain"]), ("example.org/acme/robot", ["base"])]


def test_workspace_of_checkouts_only(tmp_path: Path) -> None:
    """A folder that only contains repositories is not a source itself."""
    package(tmp_path, "robot/base")
    git(tmp_path / "robot", "init", "--quiet")
    assert [source.repository.name for source in scan_tree(tmp_path)] == ["local/robot"]


def test_folder_of_a_checkout(tmp_path: Path) -> None:
    """A committed folder inside a checkout is read as that part of the repository."""
    package(tmp_path, "nav/amcl")
    package(tmp_path, "other")
    git(tmp_path, "init", "--quiet")
    git(tmp_path, "remote", "add", "origin", "https://example.org/acme/nav.git")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "--quiet", "--message", "x")
    source = scan(tmp_path / "nav")
    assert source.repository.name == "example.org/acme/nav"
    assert [found.path for found in source.packages] == ["nav/amcl"]


def test_given_repository(tmp_path: Path) -> None:
    """The caller of a scan may set the source's name."""
    package(tmp_path, "pkg")
    source = scan(tmp_path, Repository("local/demo", str(tmp_path)))
    assert source.repository.name == "local/demo"
    assert [found.name for found in source.packages] == ["pkg"]
