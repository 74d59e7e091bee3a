from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from extract.manifests.building import links, model_of, sources
from extract.workspaces import manifest, reader_of, written

from kg.corpus.reading import Reader

if TYPE_CHECKING:
    from pathlib import Path


def test_what_is_known_before_the_first_command(tmp_path: Path) -> None:
    """Folders, the package name and catkin's destinations are set from the start."""
    text = """
set(HERE ${CMAKE_CURRENT_SOURCE_DIR})
add_executable(${PROJECT_NAME}_a ${CMAKE_SOURCE_DIR}/a.cpp ${HERE}/b.cpp ${PROJECT_SOURCE_DIR}/c.cpp)
install(DIRECTORY scripts DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
"""
    files = {"CMakeLists.txt": text, "scripts/s.py": "", **dict.fromkeys(["a.cpp", "b.cpp", "c.cpp"], "")}
    model = model_of(reader_of(tmp_path, files))
    assert sources(model) == {"demo_a": ["a.cpp", "b.cpp", "c.cpp"]}
    assert [script.name for script in model.scripts] == ["s.py"]


def test_a_project_whose_name_a_module_outside_computes(tmp_path: Path) -> None:
    """`project(${unknown} VERSION ...)` keeps the package's name, of which the names of targets are made."""
    text = """
find_package(boilerplate REQUIRED)
extract_package_metadata(pkg)
project(${pkg_extracted_name} VERSION ${pkg_extracted_version} LANGUAGES CXX)
add_executable(${PROJECT_NAME}_node a.cpp)
"""
    assert sources(model_of(reader_of(tmp_path, {"CMakeLists.txt": text, "a.cpp": ""}))) == {"demo_node": ["a.cpp"]}


@pytest.mark.parametrize(
    ("tool", "expected"),
    [("catkin", ["one", "one_env"]), ("ament_cmake", ["two", "two_env"])],
)
def test_packages_for_both_versions(tmp_path: Path, tool: str, expected: list[str]) -> None:
    """In a file for both versions of ROS the part for the package's own version is used."""
    text = """
find_package(catkin QUIET)
if(catkin_FOUND) add_executable(one) elseif(ament_cmake_FOUND) add_executable(two) endif()
if($ENV{ROS_VERSION} EQUAL 1) add_executable(one_env) endif()
if("$ENV{ROS_VERSION}" STREQUAL "2") add_executable(two_env) endif()
"""
    package = f"<package format='2'><name>demo</name><buildtool_depend>{tool}</buildtool_depend></package>"
    model = model_of(reader_of(tmp_path, {"CMakeLists.txt": text, "package.xml": package}))
    assert list(links(model)) == expected


@pytest.mark.parametrize(("tool", "expected"), [("catkin", ["one"]), ("ament_cmake", ["two", "ours"])])
def test_packages_for_both_versions_that_ask_for_the_build_tool(tmp_path: Path, tool: str, expected: list[str]) -> None:
    """A file that looks at what catkin sets has the part for the package's own version."""
    text = """
set(BY_CATKIN FALSE)
if(CATKIN_TOPLEVEL OR CATKIN_ENABLE_TESTING OR CATKIN_DEVEL_PREFIX) set(BY_CATKIN TRUE) endif()
if(BY_CATKIN) add_executable(one) else() add_executable(two) endif()
if(NOT DEFINED CATKIN_DEVEL_PREFIX) add_executable(ours) endif()
"""
    package = f"<package format='2'><name>demo</name><buildtool_depend>{tool}</buildtool_depend></package>"
    model = model_of(reader_of(tmp_path, {"CMakeLists.txt": text, "package.xml": package}))
    assert list(links(model)) == expected


def test_package_without_cmake(tmp_path: Path) -> None:
    """A package may have no CMakeLists.txt; unreferenced ones in subfolders are ignored."""
    model = model_of(reader_of(tmp_path, {"vendor/CMakeLists.txt": "add_executable(a)"}))
    assert model.targets == ()


def test_loose_code(tmp_path: Path) -> None:
    """In loose code without a manifest the topmost CMakeLists.txt of each folder is run."""
    root = tmp_path / "loose"
    files = {
        "one/CMakeLists.txt": "add_executable(one a.cpp)",
        "one/a.cpp": "",
        "one/sub/CMakeLists.txt": "add_executable(hidden)",
        "deep/two/CMakeLists.txt": "add_executable(two)",
    }
    workspace = written(root, files)
    found = workspace.package("loose")
    assert found is not None
    assert [(t.name, t.sources) for t in model_of(Reader(workspace, *workspace.folder(found))).targets] == [
        ("one", ("one/a.cpp",)),
        ("two", ()),
    ]


def test_package_in_the_root_of_its_source(tmp_path: Path) -> None:
    """A repository that is one package has paths without a folder prefix."""
    files = {"package.xml": manifest("demo"), "CMakeLists.txt": "add_executable(a src/a.cpp)", "src/a.cpp": ""}
    workspace = written(tmp_path, files)
    found = workspace.package("demo")
    assert found is not None
    (target,) = model_of(Reader(workspace, *workspace.folder(found))).targets
    assert (target.sources, str(target.location)) == (("src/a.cpp",), "CMakeLists.txt:1")
