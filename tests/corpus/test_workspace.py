from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from extract.workspaces import manifest, written

from kg.corpus.workspace import FilePath, Workspace, scan

if TYPE_CHECKING:
    from pathlib import Path


def build(root: Path, *files: str) -> tuple[Workspace, str]:
    """Write empty files, with packages as first folders of their paths; return the workspace and its source's name."""
    content = dict.fromkeys(files, "")
    content |= {f"{path.split('/')[0]}/package.xml": manifest(path.split("/")[0]) for path in files}
    workspace = written(root, content)
    return workspace, workspace.sources[0].repository.name


def test_include_prefers_what_is_near(tmp_path: Path) -> None:
    """A header next to the file precedes one in the package's include folder, which precedes other packages."""
    workspace, name = build(tmp_path, "a/src/x.hpp", "a/src/deep/y.cpp", "a/include/x.hpp", "b/include/x.hpp")
    assert workspace.include("x.hpp", near=FilePath(name, "a/src/n.cpp")) == (name, "a/src/x.hpp")
    assert workspace.include("x.hpp", near=FilePath(name, "a/src/deep/y.cpp")) == (name, "a/include/x.hpp")
    assert workspace.include("../x.hpp", near=FilePath(name, "a/src/deep/y.cpp")) == (name, "a/src/x.hpp")


def test_include_from_other_packages(tmp_path: Path) -> None:
    """Headers of other packages are found by their include paths; those outside packages are not."""
    workspace, name = build(tmp_path, "a/src/n.cpp", "b/include/b/base.hpp", "c/src/vendor/b/base.hpp")
    near = FilePath(name, "a/src/n.cpp")
    assert workspace.include("b/base.hpp", near=near) == (name, "b/include/b/base.hpp")
    assert workspace.include("ros/ros.h", near=near) is None
    assert workspace.include("ase.hpp", near=near) is None


def test_plain_names_are_not_taken_from_anywhere(tmp_path: Path) -> None:
    """A name without a folder refers to a header of another package only if that is in its public folder."""
    files = ("a/src/n.cpp", "a/src/deep/own.h", "b/src/string.h", "c/include/public.h", "d/include/d/half.h")
    workspace, name = build(tmp_path, *files)
    near = FilePath(name, "a/src/n.cpp")
    assert workspace.include("own.h", near=near) == (name, "a/src/deep/own.h")
    assert workspace.include("string.h", near=near) is None
    assert workspace.include("public.h", near=near) == (name, "c/include/public.h")
    assert workspace.include("half.h", near=near) == (name, "d/include/d/half.h")


def test_include_across_sources(tmp_path: Path) -> None:
    """A header of another source is found if this one has none."""
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    one, _ = build(tmp_path / "one", "a/src/n.cpp")
    two, _ = build(tmp_path / "two", "b/include/b/base.hpp")
    workspace = Workspace((*one.sources, *two.sources))
    assert workspace.include("b/base.hpp", near=FilePath("local/one", "a/src/n.cpp")) == (
        "local/two",
        "b/include/b/base.hpp",
    )


def test_module_of_the_own_package(tmp_path: Path) -> None:
    """Modules are found next to the script, in `src/` and in the folder of the package."""
    files = ("a/scripts/talker.py", "a/scripts/helper.py", "a/src/a/core.py", "a/src/a/__init__.py", "a/a2/node.py")
    workspace, name = build(tmp_path, *files)
    near = FilePath(name, "a/scripts/talker.py")
    assert workspace.module("helper", near=near) == (name, "a/scripts/helper.py")
    assert workspace.module("a.core", near=near) == (name, "a/src/a/core.py")
    assert workspace.module("a", near=near) == (name, "a/src/a/__init__.py")
    assert workspace.module("a2.node", near=near) == (name, "a/a2/node.py")
    assert workspace.module("rospy", near=near) is None


def test_a_source_folder_with_an_init_file_is_an_import_root(tmp_path: Path) -> None:
    """A stray `src/__init__.py` hides no module from other packages; a folder inside of a Python package is no root."""
    files = ("a/scripts/n.py", "b/src/__init__.py", "b/src/b/__init__.py", "b/src/b/core.py", "b/src/b/deep/own.py")
    workspace, name = build(tmp_path, *files)
    near = FilePath(name, "a/scripts/n.py")
    assert workspace.module("b.core", near=near) == (name, "b/src/b/core.py")
    assert workspace.module("core", near=near) is None


def test_a_source_folder_below_another_one_is_a_root(tmp_path: Path) -> None:
    """A stray `ros/src/__init__.py` hides no module from the programs of its package."""
    files = ("a/ros/scripts/n.py", "a/ros/src/__init__.py", "a/ros/src/lib/__init__.py", "a/ros/src/lib/core.py")
    workspace, name = build(tmp_path, *files)
    near = FilePath(name, "a/ros/scripts/n.py")
    assert workspace.module("lib.core", near=near) == (name, "a/ros/src/lib/core.py")


def test_relative_module(tmp_path: Path) -> None:
    """Leading dots climb from the folder of the importing file."""
    workspace, name = build(tmp_path, "a/a/__init__.py", "a/a/sub/__init__.py", "a/a/sub/x.py", "a/a/y.py")
    near = FilePath(name, "a/a/sub/x.py")
    assert workspace.module("..y", near=near) == (name, "a/a/y.py")
    assert workspace.module(".", near=near) == (name, "a/a/sub/__init__.py")
    assert workspace.module(".missing", near=near) is None


def test_module_of_another_package(tmp_path: Path) -> None:
    """A module of another package is found below an import root, never inside a Python package."""
    files = ("a/n.py", "b/src/b/__init__.py", "b/src/b/tools.py", "c/c/__init__.py", "c/c/tools.py")
    workspace, name = build(tmp_path, *files)
    near = FilePath(name, "a/n.py")
    assert workspace.module("b.tools", near=near) == (name, "b/src/b/tools.py")
    assert workspace.module("tools", near=near) is None


def test_programs_are_not_the_package_of_their_name(tmp_path: Path) -> None:
    """A program named like its ROS package is not the module that other packages import by that name."""
    workspace, name = build(tmp_path, "a/src/n.py", "queue/nodes/queue.py", "tools/src/helper.py")
    assert workspace.module("queue", near=FilePath(name, "a/src/n.py")) is None
    assert workspace.module("helper", near=FilePath(name, "a/src/n.py")) == (name, "tools/src/helper.py")


def test_definitions(tmp_path: Path) -> None:
    """Interface definitions are found by package, name and kind."""
    workspace, name = build(tmp_path, "a/msg/Scan.msg", "a/srv/Scan.srv")
    assert workspace.definition("a", "Scan", "srv") == (name, "a/srv/Scan.srv")
    assert workspace.definition("a", "Scan", "action") is None
    assert workspace.definition("b", "Scan", "msg") is None


def test_packages_and_owners(tmp_path: Path) -> None:
    """Packages are found by name, files have an owner; the first source's package of a name wins."""
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        build(tmp_path / folder, "a/n.cpp")
    workspace = Workspace([scan(tmp_path / "one"), scan(tmp_path / "two")])
    found = workspace.package("a")
    assert found is not None
    assert found.repository == "local/one"
    assert workspace.package("b") is None
    owner = workspace.owner(FilePath("local/two", "a/n.cpp"))
    assert owner is not None
    assert owner.name == "a"
    entry = workspace.entry(FilePath("local/two", "a/n.cpp"))
    assert entry is not None
    assert entry.bytes == 0
    assert workspace.entry(FilePath("local/two", "a/none.cpp")) is None
    assert workspace.source("local/three") is None


@pytest.mark.parametrize("path", ["ros/ros.h", "sensor_msgs/Imu.h", "assert.h"])
def test_libraries_that_another_source_copied_are_not_meant(tmp_path: Path, path: str) -> None:
    """A package of another source exports its include roots and folders of its name, without bundled libraries."""
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    one, _ = build(tmp_path / "one", "a/src/n.cpp")
    two, _ = build(
        tmp_path / "two",
        f"b/wrap/include/{path}",
        "b/lib/include/ros/assert.h",
        "b/lib/b/base.hpp",
        "b/part/include/parts/p.hpp",
    )
    workspace = Workspace((*one.sources, *two.sources))
    near = FilePath("local/one", "a/src/n.cpp")
    assert workspace.include(path, near=near) is None
    assert workspace.include("b/base.hpp", near=near) == ("local/two", "b/lib/b/base.hpp")
    assert workspace.include("parts/p.hpp", near=near) == ("local/two", "b/part/include/parts/p.hpp")


def test_headers_of_the_language_are_not_those_of_other_packages(tmp_path: Path) -> None:
    """`time.h` refers to a header of the same package, or that of C."""
    workspace, name = build(tmp_path, "a/src/n.cpp", "b/include/time.h", "b/src/m.cpp")
    assert workspace.include("time.h", near=FilePath(name, "a/src/n.cpp")) is None
    assert workspace.include("time.h", near=FilePath(name, "b/src/m.cpp")) == (name, "b/include/time.h")
