from __future__ import annotations

import pytest

from kg.corpus.files import PackageFolder, sort_file
from kg.facts import FileKind


@pytest.mark.parametrize(
    ("name", "folder", "kind"),
    [
        ("node.cpp", "src", FileKind.CPP),
        ("node.HPP", "include", FileKind.CPP),
        ("kernel.cu", "src", FileKind.CPP),
        ("config.h.in", "include", FileKind.CPP),
        ("talker.py", "scripts", FileKind.PYTHON),
        ("Scan.msg", "msg", FileKind.MESSAGE),
        ("Reset.srv", "srv", FileKind.SERVICE),
        ("Go.action", "action", FileKind.ACTION),
        ("base.launch", "launch", FileKind.LAUNCH),
        ("base.launch.xml", "anywhere", FileKind.LAUNCH),
        ("base.launch.py", "anywhere", FileKind.LAUNCH),
        ("bringup_launch.py", "anywhere", FileKind.LAUNCH),
        ("base.xml", "launch", FileKind.LAUNCH),
        ("base.yaml", "launch", FileKind.LAUNCH),
        ("helper.py", "launch", FileKind.LAUNCH),
        ("hz.test", "test", FileKind.LAUNCH),
        ("package.xml", "pkg", FileKind.MANIFEST),
        ("CMakeLists.txt", "pkg", FileKind.BUILD),
        ("extras.cmake.in", "cmake", FileKind.BUILD),
        ("setup.py", "pkg", FileKind.BUILD),
        ("nodelet_plugins.xml", "pkg", FileKind.PLUGIN),
        ("params.yaml", "config", FileKind.CONFIG),
        ("Camera.cfg", "cfg", FileKind.CONFIG),
        ("README.md", "pkg", FileKind.TEXT),
        ("LICENSE", "pkg", FileKind.TEXT),
        ("picture.png", "doc", None),
        ("library.so", "lib", None),
        ("noending", "scripts", None),
        (".clang-format", "pkg", None),
    ],
)
def test_sorting(name: str, folder: str, kind: FileKind | None) -> None:
    """Files are classified by name, suffix and the folder that ROS uses for them."""
    assert sort_file(name, folder) is kind


def test_modules_of_a_package_called_launch_are_code() -> None:
    """A Python package named `launch` contains modules, but its launch files remain launch files."""
    assert sort_file("actions.py", "launch", in_module=True) is FileKind.PYTHON
    assert sort_file("demo.launch.py", "launch", in_module=True) is FileKind.LAUNCH


def test_join_knows_the_root() -> None:
    """Paths of a package in the root of its source have no folder prefix."""
    assert PackageFolder("a", ".", None, ()).join("src/x.cpp") == "src/x.cpp"
    assert PackageFolder("a", "nav/a", None, ()).join("src/x.cpp") == "nav/a/src/x.cpp"
