from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from extract.manifests.building import cmake, links, model_of, sources
from extract.workspaces import reader_of

from kg.extract.buildmodel import Registration, TargetKind

if TYPE_CHECKING:
    from pathlib import Path


def test_targets(tmp_path: Path) -> None:
    """Executables and libraries have kind, existing sources, links and line."""
    text = """project(demo)
add_executable(node EXCLUDE_FROM_ALL src/main.cpp src/missing.cpp README.md $<$<BOOL:ON>:src/more.cpp>)
add_library(${PROJECT_NAME} SHARED src/lib)
target_sources(node PRIVATE src/late.cpp)
target_link_libraries(node PUBLIC demo -lm debug $<BUILD_INTERFACE:other> other::other)
ament_target_dependencies(demo PUBLIC rclcpp)
"""
    files = ["src/main.cpp", "src/more.cpp", "src/late.cpp", "src/lib.cpp", "README.md"]
    model = cmake(tmp_path, text, files)
    assert sources(model) == {"node": ["src/main.cpp", "src/more.cpp", "src/late.cpp"], "demo": ["src/lib.cpp"]}
    assert links(model) == {"node": ["demo", "other", "other::other"], "demo": ["rclcpp"]}
    kinds = [(target.kind, target.location.line) for target in model.targets]
    assert kinds == [(TargetKind.EXECUTABLE, 2), (TargetKind.LIBRARY, 3)]


def test_programs_of_commands_that_other_packages_define(tmp_path: Path) -> None:
    """A command without a definition whose name ends in `executable` or `binary` makes a program of its sources."""
    text = """
rosbuild_add_executable(bin/teleop src/teleop.cpp)
google_binary(mapper
  SRCS
    mapper_main.cc
)
print_binary_size(mapper)
"""
    model = cmake(tmp_path, text, ["src/teleop.cpp", "mapper_main.cc"])
    assert sources(model) == {"teleop": ["src/teleop.cpp"], "mapper": ["mapper_main.cc"]}
    assert {target.kind for target in model.targets} == {TargetKind.EXECUTABLE}


def test_library_and_program_of_one_name(tmp_path: Path) -> None:
    """Files of rosbuild may name a library like a program, which both stay what they are."""
    text = """
rosbuild_add_library(${PROJECT_NAME} driver.cpp)
rosbuild_add_executable(${PROJECT_NAME} node.cpp)
rosbuild_add_executable(other other.cpp)
target_link_libraries(other ${PROJECT_NAME})
"""
    model = cmake(tmp_path, text, ["driver.cpp", "node.cpp", "other.cpp"])
    assert sources(model) == {"libdemo": ["driver.cpp"], "demo": ["node.cpp"], "other": ["other.cpp"]}
    assert links(model) == {"libdemo": [], "demo": ["libdemo"], "other": ["libdemo"]}
    assert {target.name: target.kind for target in model.targets}["demo"] is TargetKind.EXECUTABLE


def test_aliases_objects_and_imported(tmp_path: Path) -> None:
    """Aliases lead to their target, objects of a library count as links, imported targets are excluded."""
    text = """
add_library(core OBJECT a.cpp)
add_library(demo::core ALIAS core)
add_library(system SHARED IMPORTED)
add_executable(node $<TARGET_OBJECTS:core>)
target_link_libraries(node demo::core)
target_link_libraries(unknown x)
"""
    model = cmake(tmp_path, text, ["a.cpp"])
    assert links(model) == {"core": [], "node": ["core"]}


@pytest.mark.parametrize(
    "command",
    [
        "set_target_properties(node PROPERTIES X y OUTPUT_NAME talker)",
        "set_property(TARGET node PROPERTY OUTPUT_NAME talker)",
    ],
)
def test_output_names(tmp_path: Path, command: str) -> None:
    """The output name of a target may differ from its own."""
    (target,) = cmake(tmp_path, f"add_executable(node)\n{command}").targets
    assert (target.name, target.output_name) == ("node", "talker")


def test_components(tmp_path: Path) -> None:
    """Components are registered by class, with the executable generated for one."""
    text = """
add_library(core SHARED a.cpp)
set_target_properties(core PROPERTIES OUTPUT_NAME demo_core)
rclcpp_components_register_node(core PLUGIN "demo::Talker" EXECUTABLE talker EXECUTOR MultiThreadedExecutor)
rclcpp_components_register_nodes(core "demo::One" "demo::Two")
rclcpp_components_register_nodes(core ${none})
"""
    model = cmake(tmp_path, text, ["a.cpp"])
    assert [(p.name, p.registration, p.library, p.executable, p.location.line) for p in model.plugins] == [
        ("demo::Talker", Registration.COMPONENT, "demo_core", "talker", 4),
        ("demo::One", Registration.COMPONENT, "demo_core", None, 5),
        ("demo::Two", Registration.COMPONENT, "demo_core", None, 5),
    ]


def test_installed_programs(tmp_path: Path) -> None:
    """Installed Python programs are scripts with their installed names and the lines that install them."""
    shebang = "#!/usr/bin/env python3\n"
    text = """install(PROGRAMS scripts/a.py nodes/b DESTINATION lib/${PROJECT_NAME})
install(PROGRAMS scripts/c.py RENAME c DESTINATION lib/${PROJECT_NAME})
catkin_install_python(PROGRAMS scripts/d.py DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(DIRECTORY tools/ DESTINATION lib/${PROJECT_NAME} USE_SOURCE_PERMISSIONS)
install(DIRECTORY share DESTINATION share/${PROJECT_NAME})
install(TARGETS x DESTINATION lib)
install(PROGRAMS scripts/gone.py run.sh DESTINATION lib)
install(DIRECTORY src/ DESTINATION lib/${PROJECT_NAME} FILES_MATCHING PATTERN "start" PERMISSIONS OWNER_EXECUTE)
install(DIRECTORY src/ DESTINATION lib/${PROJECT_NAME} PATTERN "*.py" PATTERN "left_out" EXCLUDE)
install(DIRECTORY data/ DESTINATION share/${PROJECT_NAME} FILES_MATCHING PATTERN "shared")
"""
    files = dict.fromkeys(["scripts/a.py", "scripts/c.py", "scripts/d.py", "tools/e.py", "share/f.py"], shebang)
    model = cmake(tmp_path, text, ["run.sh"], **files, **{"nodes/b.py": shebang})
    found = {script.name: (script.path, str(script.location)) for script in model.scripts}
    assert found == {
        "a.py": ("demo/scripts/a.py", "demo/CMakeLists.txt:1"),
        "c": ("demo/scripts/c.py", "demo/CMakeLists.txt:2"),
        "d.py": ("demo/scripts/d.py", "demo/CMakeLists.txt:3"),
        "e.py": ("demo/tools/e.py", "demo/CMakeLists.txt:4"),
        "b.py": ("demo/nodes/b.py", "demo/nodes/b.py:1"),
    }
    assert model.programs == ("a.py", "b", "c", "d.py", "gone.py", "run.sh", "start")


def test_parameter_and_reconfigure_files(tmp_path: Path) -> None:
    """YAML files of generate_parameter_library and cfg files of dynamic_reconfigure are recorded."""
    text = """
generate_parameter_library(talker_parameters src/talker.yaml include/validators.hpp)
generate_parameter_module(listener_parameters demo/listener.yaml)
generate_dynamic_reconfigure_options(cfg/A.cfg cfg/gone.cfg)
"""
    model = cmake(tmp_path, text, ["cfg/A.cfg", "cfg/B.cfg", "other/C.cfg"])
    pairs = (("talker_parameters", "demo/src/talker.yaml"), ("listener_parameters", "demo/demo/listener.yaml"))
    assert model.parameter_libraries == pairs
    assert model.reconfigure_files == ("demo/cfg/A.cfg", "demo/cfg/B.cfg")


def test_generated_sources(tmp_path: Path) -> None:
    """For a source generated by configure_file the template is read."""
    text = """
set(KIND lidar)
configure_file(src/driver.cpp.in src/driver.cpp)
add_executable(driver src/driver.cpp)
"""
    assert sources(cmake(tmp_path, text, ["src/driver.cpp.in"])) == {"driver": ["src/driver.cpp.in"]}


def test_programs_that_run_one_plugin(tmp_path: Path) -> None:
    """An executable that consists of a generated loader is that of the loaded plugin."""
    files = {
        "CMakeLists.txt": """
macro(nodelet name source)
  set(NODELET demo/${name})
  configure_file(src/run.cpp.in ${name}.cpp @ONLY)
  add_executable(${name}_exe ${name}.cpp)
  set_target_properties(${name}_exe PROPERTIES OUTPUT_NAME ${name})
  list(APPEND sources ${source})
endmacro()
nodelet(edge src/edge.cpp)
add_library(demo ${sources})
""",
        "src/run.cpp.in": 'int main() { manager.load("@NODELET@"); }',
        "src/edge.cpp": "",
        "nodelet_plugins.xml": """<library path="lib/libdemo">
  <class name="demo/edge" type="demo::Edge" base_class_type="nodelet::Nodelet"/>
</library>""",
    }
    model = model_of(reader_of(tmp_path, files))
    assert sources(model) == {"demo": ["src/edge.cpp"]}
    (plugin,) = model.plugins
    assert (plugin.name, plugin.executable, plugin.library) == ("demo/edge", "edge", "demo")
