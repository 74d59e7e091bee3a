from __future__ import annotations

from typing import TYPE_CHECKING

from extract.manifests.building import cmake, model_of, sources
from extract.workspaces import codes, reader_of

if TYPE_CHECKING:
    from pathlib import Path


def names(root: Path, text: str) -> list[str]:
    """Return the names of the targets of a CMakeLists.txt."""
    return [target.name for target in cmake(root, text).targets]


def test_decided_branches(tmp_path: Path) -> None:
    """Of a decided `if` only the branch taken counts."""
    text = """
set(USE_IT ON)
if(USE_IT) add_executable(a) elseif(TRUE) add_executable(b) else() add_executable(c) endif()
if(WIN32) add_executable(windows) endif()
if(NOT UNIX) return() endif()
add_executable(last)
"""
    assert names(tmp_path, text) == ["a", "last"]


def test_open_branches(tmp_path: Path) -> None:
    """Of an `if` that depends on the machine every branch counts, and none of them ends the file."""
    text = """
option(BUILD_EXTRA "more" OFF)
if(BUILD_EXTRA) add_executable(extra) else() add_executable(plain) endif()
find_package(OpenCV)
if(NOT OpenCV_FOUND) return() endif()
add_executable(last)
"""
    assert names(tmp_path, text) == ["extra", "plain", "last"]


def test_variables_of_open_branches_are_united(tmp_path: Path) -> None:
    """A list of sources that differs between branches is the union of both."""
    text = """
if(SOMETHING) set(SRC a.cpp both.cpp) else() set(SRC b.cpp both.cpp) endif()
add_executable(node ${SRC})
"""
    model = cmake(tmp_path, text, ["a.cpp", "b.cpp", "both.cpp"])
    assert sources(model) == {"node": ["a.cpp", "both.cpp", "b.cpp"]}


def test_loops(tmp_path: Path) -> None:
    """All forms of foreach run, with break and continue."""
    text = """
set(LIST c d)
foreach(x a b) add_executable(${x}) endforeach()
foreach(x IN LISTS LIST ITEMS e) add_executable(${x}) endforeach()
foreach(x RANGE 1 7 3) add_executable(n${x}) endforeach()
foreach(x RANGE 1) add_executable(m${x}) endforeach()
foreach(x f g h i)
  if(x STREQUAL "g") continue() endif()
  if(x STREQUAL "i") break() endif()
  add_executable(${x})
endforeach()
add_executable(x${x})
"""
    assert names(tmp_path, text) == ["a", "b", "c", "d", "e", "n1", "n4", "n7", "m0", "m1", "f", "h", "x"]


def test_counting_loop(tmp_path: Path) -> None:
    """A while over a counter runs the right number of times."""
    text = """
set(i 0)
while(i LESS 3)
  add_executable(n${i})
  math(EXPR i "${i} + 1")
endwhile()
"""
    assert names(tmp_path, text) == ["n0", "n1", "n2"]


def test_macros_and_functions(tmp_path: Path) -> None:
    """Macros and functions run with their arguments; a function's variables are local unless exported."""
    text = """
macro(make name)
  add_executable(${name} ${ARGN})
  set(LAST ${name})
endmacro()
function(wrap name)
  make(${name}_node ${ARGV1})
  set(SEEN ${name}${ARGC} PARENT_SCOPE)
  set(HIDDEN x)
endfunction()
make(one a.cpp b.cpp)
wrap(two a.cpp)
add_executable(${LAST}_${SEEN}_${HIDDEN})
"""
    model = cmake(tmp_path, text, ["a.cpp", "b.cpp"])
    assert sources(model) == {"one": ["a.cpp", "b.cpp"], "two_node": ["a.cpp"], "one_two2_": []}


def test_targets_stand_where_the_macro_is_called(tmp_path: Path) -> None:
    """A target made in a macro has the line of the outermost call."""
    text = "macro(inner n)\nadd_executable(${n})\nendmacro()\nmacro(outer n)\ninner(${n})\nendmacro()\n\nouter(a)\n"
    (target,) = cmake(tmp_path, text).targets
    assert str(target.location) == "demo/CMakeLists.txt:8"


def test_keyword_arguments(tmp_path: Path) -> None:
    """cmake_parse_arguments works in both its forms."""
    text = """
function(node)
  cmake_parse_arguments(ARG "TEST" "NAME" "SOURCES;LIBS" ${ARGN})
  add_executable(${ARG_NAME} ${ARG_SOURCES})
  target_link_libraries(${ARG_NAME} ${ARG_LIBS} ${ARG_UNPARSED_ARGUMENTS} ${ARG_TEST})
endfunction()
function(late first)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "NAME" "")
  add_executable(${first}_${ARG_NAME})
endfunction()
node(NAME a SOURCES a.cpp b.cpp TEST loose LIBS m)
late(x NAME y)
"""
    model = cmake(tmp_path, text, ["a.cpp", "b.cpp"])
    assert sources(model) == {"a": ["a.cpp", "b.cpp"], "x_y": []}
    assert model.targets[0].links == ("m", "loose", "TRUE")


def test_subdirectories_and_includes(tmp_path: Path) -> None:
    """A subdirectory has a scope and folder of its own, an included file has those of its includer."""
    files = {
        "CMakeLists.txt": "set(N top)\nadd_subdirectory(src)\ninclude(cmake/more.cmake)\nadd_executable(${N} main.cpp)",
        "src/CMakeLists.txt": "set(N sub)\nadd_executable(${N} main.cpp ../main.cpp ${PROJECT_SOURCE_DIR}/lib/x.cpp)",
        "cmake/more.cmake": "set(N more)\nadd_executable(inc ${CMAKE_CURRENT_LIST_DIR}/in.cpp main.cpp)",
        **dict.fromkeys(["src/main.cpp", "main.cpp", "lib/x.cpp", "cmake/in.cpp"], ""),
    }
    model = model_of(reader_of(tmp_path, files))
    assert sources(model) == {
        "sub": ["src/main.cpp", "main.cpp", "lib/x.cpp"],
        "inc": ["cmake/in.cpp", "main.cpp"],
        "more": ["main.cpp"],
    }
    assert str(model.targets[0].location) == "demo/src/CMakeLists.txt:2"


def test_files_that_include_themselves(tmp_path: Path) -> None:
    """Endless recursion of files, macros and loops is stopped, and earlier targets remain."""
    text = """
add_executable(first)
include(CMakeLists.txt)
macro(again) again() endmacro()
again()
while(TRUE) set(x "${x}${x}y") endwhile()
foreach(i RANGE 1000000000) endforeach()
add_executable(last)
"""
    assert {"first", "last"} >= set(names(tmp_path, text)) >= {"first"}


def test_work_is_bounded(tmp_path: Path) -> None:
    """An endless computation is stopped, and that is reported."""
    text = "foreach(i RANGE 2000)\nforeach(j RANGE 2000)\nset(x a)\nendforeach()\nendforeach()\nadd_executable(late)"
    reader = reader_of(tmp_path, {"CMakeLists.txt": f"add_executable(first)\n{text}"})
    assert [target.name for target in model_of(reader).targets] == ["first"]
    assert [code for code, _ in codes(reader.problems)] == ["KG122"]


def test_deep_nesting(tmp_path: Path) -> None:
    """5,000 nested ifs neither crash nor hide the targets outside them."""
    text = "add_executable(a)\n" + "if(X)\n" * 5000 + "endif()\n" * 5000 + "add_executable(b)\n"
    assert names(tmp_path, text) == ["a", "b"]


def test_malformed_file(tmp_path: Path) -> None:
    """A file with a syntax error is reported with its line; earlier commands count."""
    reader = reader_of(tmp_path, {"CMakeLists.txt": "add_executable(a)\nadd_executable(b\n"})
    assert [target.name for target in model_of(reader).targets] == ["a"]
    assert codes(reader.problems) == [("KG117", 2)]


def test_blocks_nested_too_deep_are_named(tmp_path: Path) -> None:
    """Blocks below the deepest level are skipped, and that is reported."""
    text = "add_executable(first)\n" + "if(TRUE)\n" * 100 + "add_executable(deep)\n" + "endif()\n" * 100
    reader = reader_of(tmp_path, {"CMakeLists.txt": text})
    assert [target.name for target in model_of(reader).targets] == ["first"]
    assert [code for code, _ in codes(reader.problems)] == ["KG114"]
