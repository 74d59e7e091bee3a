from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from extract.manifests.building import cmake, sources
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

if TYPE_CHECKING:
    from pathlib import Path


def value(root: Path, text: str) -> str:
    """Run commands and return the elements of the variable `v`, as the links of a target."""
    model = cmake(root, f"add_library(t)\n{text}\ntarget_link_libraries(t ${{v}})\n")
    return " ".join(model.targets[0].links)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("set(v a b)", "a b"),
        ('set(v "a;b" c)', "a b c"),
        ("set(v a)\nset(v)", ""),
        ("set(v a)\nunset(v)", ""),
        ("set(v a CACHE STRING doc)", "a"),
        ("list(APPEND v a b)\nlist(APPEND v c)", "a b c"),
        ("set(v b)\nlist(PREPEND v a)", "a b"),
        ("set(v a b c b)\nlist(REMOVE_ITEM v b)", "a c"),
        ("set(v a b a)\nlist(REMOVE_DUPLICATES v)", "a b"),
        ("set(v b a)\nlist(SORT v)", "a b"),
        ("set(v b a)\nlist(REVERSE v)", "a b"),
        ("set(v a c)\nlist(INSERT v 1 b)", "a b c"),
        ("set(v a b)\nlist(REMOVE_AT v 0)", "b"),
        ('set(v a.cpp b.h)\nlist(FILTER v EXCLUDE REGEX "[.]h$")', "a.cpp"),
        ('set(v a.cpp b.h)\nlist(FILTER v INCLUDE REGEX "[.]h$")', "b.h"),
        ("set(v a b)\nlist(TRANSFORM v PREPEND src/)", "src/a src/b"),
        ("set(v a b)\nlist(TRANSFORM v APPEND .c)", "a.c b.c"),
        ("set(l a b c)\nlist(GET l 0 2 v)", "a c"),
        ("set(l a b c)\nlist(LENGTH l v)", "3"),
        ("set(l a b)\nlist(JOIN l + v)", "a+b"),
        ("set(l a b)\nlist(FIND l b v)", "1"),
        ("string(TOLOWER AbC v)", "abc"),
        ("string(REPLACE _ x v a_b_)", "axbx"),
        (r'string(REGEX REPLACE "^(.*)[.]cpp$" "\\1_t" v a.cpp)', "a_t"),
        ('string(REGEX REPLACE "(a+)+$" "" v aaaaaaaaaaaaaaaaaaaaaaaaaaaaa!)', "aaaaaaaaaaaaaaaaaaaaaaaaaaaaa!"),
        ("string(CONCAT v a b)", "ab"),
        ("set(v a)\nstring(APPEND v b)", "ab"),
        ("string(JOIN + v a b)", "a+b"),
        ("get_filename_component(v src/a.b.cpp NAME_WE)", "a"),
        ("get_filename_component(v src/a.b.cpp NAME)", "a.b.cpp"),
        ("get_filename_component(v src/a.cpp DIRECTORY)", "src"),
        ("get_filename_component(v src/a.cpp EXT)", ".cpp"),
        ('math(EXPR v "2 * (3 + 1)")', "8"),
        ("set(ENV{x} y)\nset(v a)", "a"),
        ("list()\nstring()\nset()\nmath()\nfile()\nget_filename_component()\nconfigure_file()\nset(v a)", "a"),
    ],
)
def test_values(tmp_path: Path, text: str, expected: str) -> None:
    """Built-in commands give the results of CMake, and tolerate missing arguments."""
    assert value(tmp_path, text) == expected


def test_globbing(tmp_path: Path) -> None:
    """Patterns are matched against the files of the package, sorted, in all forms of CMake."""
    text = """
file(GLOB flat src/*.cpp)
file(GLOB_RECURSE deep RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS "src/*.cpp" ${PROJECT_SOURCE_DIR}/lib/*.c)
file(GLOB middle src/*/x.cpp)
aux_source_directory(src aux)
add_executable(flat ${flat})
add_executable(deep ${deep})
add_executable(middle ${middle})
add_executable(aux ${aux})
"""
    files = ["src/b.cpp", "src/a.cpp", "src/in/x.cpp", "src/in/er/x.cpp", "lib/c.c", "src/a.hpp"]
    assert sources(cmake(tmp_path, text, files)) == {
        "flat": ["src/a.cpp", "src/b.cpp"],
        "deep": ["src/a.cpp", "src/b.cpp", "src/in/er/x.cpp", "src/in/x.cpp", "lib/c.c"],
        "middle": ["src/in/x.cpp"],
        "aux": ["src/a.cpp", "src/b.cpp"],
    }


def test_globs_stay_inside(tmp_path: Path) -> None:
    """A pattern cannot match files outside the source."""
    text = "file(GLOB x /etc/* ../../../* ${CMAKE_BINARY_DIR}/*)\nadd_executable(a ${x})"
    assert sources(cmake(tmp_path, text)) == {"a": []}


def test_packages_found_are_linked_by_name(tmp_path: Path) -> None:
    """`${catkin_LIBRARIES}` stands for the catkin packages found, `${x_LIBRARIES}` for the package x."""
    text = """
find_package(catkin REQUIRED COMPONENTS roscpp tf)
find_package(Boost REQUIRED COMPONENTS thread)
add_library(t)
target_link_libraries(t ${catkin_LIBRARIES} ${Boost_LIBRARIES} ${tf_LIBRARIES})
"""
    assert cmake(tmp_path, text).targets[0].links == ("roscpp", "tf", "Boost")


COMMANDS = st.sampled_from(
    [
        "set",
        "list",
        "string",
        "file",
        "foreach",
        "include",
        "math",
        "project",
        "find_package",
        "add_executable",
        "install",
        "configure_file",
    ]
)
WORDS = st.sampled_from(
    [
        "a;b",
        "${a}",
        "a.cpp",
        "APPEND",
        "REPLACE",
        "REGEX",
        "GLOB",
        "*",
        "..",
        "/",
        "-1",
        "IN",
        "LISTS",
        "RANGE",
        "PROGRAMS",
        "COMPONENTS",
        "CMakeLists.txt",
        "(",
        ")",
    ]
)


@settings(
    max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], deadline=None
)
@given(st.lists(st.tuples(COMMANDS, st.lists(WORDS, max_size=5)), max_size=6))
def test_any_commands(tmp_path: Path, commands: list[tuple[str, list[str]]]) -> None:
    """Any sequence of commands with any arguments runs to its end."""
    text = "\n".join(f"{name}({' '.join(words)})" for name, words in commands)
    assert cmake(tmp_path, text).entry_points == ()
