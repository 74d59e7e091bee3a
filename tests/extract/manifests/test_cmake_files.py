from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from extract.manifests.building import cmake, links, model_of, sources
from extract.workspaces import manifest, reader_of

from kg.corpus.reading import Reader
from kg.extract.buildmodel import Registration, TargetKind

if TYPE_CHECKING:
    from pathlib import Path


def test_macros_of_other_packages(tmp_path: Path) -> None:
    """Macros exported by a package found with find_package are run, and their file is an input."""
    files = {
        "CMakeLists.txt": "find_package(catkin REQUIRED COMPONENTS tools)\nadd_robot_node(driver src/driver.cpp)\n",
        "src/driver.cpp": "",
        "../tools/package.xml": manifest("tools"),
        "../tools/cmake/tools-extras.cmake.in": """
if(TRUE)
macro(ADD_ROBOT_NODE name)
  add_executable(${name}_node ${ARGN})
endmacro()
endif()
@ODD@
""",
    }
    reader = reader_of(tmp_path, files)
    assert sources(model_of(reader)) == {"driver_node": ["src/driver.cpp"]}
    assert "tools/cmake/tools-extras.cmake.in" in {name.partition(":")[2] for name, _ in reader.inputs}
    again = Reader(reader.workspace, *reader.workspace.folder(reader.place))
    model_of(again)
    assert again.inputs == reader.inputs


def test_macros_of_packages_not_asked_for(tmp_path: Path) -> None:
    """Macros of packages that were not found are unknown, even if they are in the build."""
    files = {
        "CMakeLists.txt": "add_robot_node(driver)\n",
        "../tools/package.xml": manifest("tools"),
        "../tools/cmake/tools.cmake": "macro(add_robot_node name)\nadd_executable(${name})\nendmacro()",
    }
    assert sources(model_of(reader_of(tmp_path, files))) == {}


@pytest.mark.parametrize(
    ("call", "kind"),
    [
        ("cs_add_executable(t a.cpp)", TargetKind.EXECUTABLE),
        ("cs_add_library(t a.cpp)", TargetKind.LIBRARY),
        ("rosbuild_add_executable(t a.cpp)", TargetKind.EXECUTABLE),
        ("rosbuild_add_library(t a.cpp)", TargetKind.LIBRARY),
        ("cuda_add_executable(t a.cpp)", TargetKind.EXECUTABLE),
        ("cuda_add_library(t SHARED a.cpp)", TargetKind.LIBRARY),
        ("ament_auto_add_executable(t a.cpp)", TargetKind.EXECUTABLE),
        ("ament_auto_add_executable(t DIRECTORY .)", TargetKind.EXECUTABLE),
        ("ament_auto_add_library(t SHARED a.cpp)", TargetKind.LIBRARY),
        ("catkin_add_gtest(t a.cpp)", TargetKind.TEST),
        ("ament_add_gtest(t a.cpp TIMEOUT 60)", TargetKind.TEST),
        ("ament_add_gmock(t a.cpp)", TargetKind.TEST),
        ("ament_auto_add_gtest(t a.cpp)", TargetKind.TEST),
        ("add_rostest_gtest(t test/t.test a.cpp)", TargetKind.TEST),
    ],
)
def test_well_known_macros(tmp_path: Path, call: str, kind: TargetKind) -> None:
    """Macros of build tools outside the build are represented by their declarations."""
    model = cmake(tmp_path, call, ["a.cpp"])
    assert [(target.name, target.kind) for target in model.targets] == [("t", kind)]
    assert sources(model) == {"t": ["a.cpp"]}


def test_ament_auto_links(tmp_path: Path) -> None:
    """ament_auto executables link the package's ament_auto libraries and the manifest's build dependencies."""
    text = "ament_auto_add_library(core a.cpp)\nament_auto_add_executable(node b.cpp)\n"
    package = "<package format='2'><name>demo</name><depend>rclcpp</depend><exec_depend>late</exec_depend></package>"
    model = model_of(reader_of(tmp_path, {"CMakeLists.txt": text, "a.cpp": "", "b.cpp": "", "package.xml": package}))
    assert links(model) == {"core": ["rclcpp"], "node": ["rclcpp", "core"]}


def test_nodelets_of_jsk(tmp_path: Path) -> None:
    """jsk_nodelet collects sources for one library; each nodelet gets a program of its own."""
    text = """
jsk_nodelet(src/edge.cpp "demo/Edge" "edge" nodelet_sources nodelet_executables)
add_library(demo SHARED ${nodelet_sources})
"""
    plugins = """<library path="lib/libdemo">
<class name="demo/Edge" type="demo::Edge" base_class_type="nodelet::Nodelet"/>
</library>"""
    files = {"CMakeLists.txt": text, "src/edge.cpp": "", "nodelet.xml": plugins}
    model = model_of(reader_of(tmp_path, files))
    assert sources(model) == {"demo": ["src/edge.cpp"]}
    assert [(p.name, p.registration, p.executable) for p in model.plugins] == [
        ("demo/Edge", Registration.NODELET, "edge")
    ]


def test_sources_through_a_link(tmp_path: Path) -> None:
    """Sources named through a linked folder are found at their real location."""
    (tmp_path / "demo").mkdir()
    (tmp_path / "shared").mkdir()
    (tmp_path / "shared" / "a.cpp").touch()
    (tmp_path / "demo" / "shared").symlink_to("../shared")
    model = model_of(reader_of(tmp_path, {"CMakeLists.txt": "add_executable(node shared/a.cpp)"}))
    assert model.targets[0].sources == ("shared/a.cpp",)
