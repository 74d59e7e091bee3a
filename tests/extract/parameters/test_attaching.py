from __future__ import annotations

from typing import TYPE_CHECKING

from extract.workspaces import reader_of

from kg.extract.buildmodel import BuildModel
from kg.extract.marks import Extracted, Mark
from kg.extract.parameters import attach
from kg.facts import Access, Location, NodeKind, NodeType, Parameter

if TYPE_CHECKING:
    from pathlib import Path

HERE = Location("demo/src/a.cpp", 4)
YAML = "ns:\n  gain: {type: double}\n"
CFG = (
    'from dynamic_reconfigure.parameter_generator_catkin import *\nParameterGenerator().add("rate", double_t, 0, "")\n'
)
FILES: dict[str, str | bytes] = {"params.yaml": YAML, "cfg/Demo.cfg": CFG}
LIBRARIES = (("demo_parameters", "demo/params.yaml"),)


def names(root: Path, build: BuildModel, *marks: Mark) -> list[tuple[str, list[str | None]]]:
    """Return name and parameter names of the nodes merged from one node with these marks."""
    reader = reader_of(root, FILES)
    node = NodeType("a", NodeKind.COMPONENT, "cpp", 2, HERE, sources=("demo/src/a.cpp",))
    nodes = attach(reader, reader.package, build, [Extracted(node, marks)])
    return [(found.node.name, [p.name for p in found.node.parameters]) for found in nodes]


def test_a_parameter_has_what_its_key_states(tmp_path: Path) -> None:
    """A declaration on the line of a key has type, default and description of the key with the same last name."""
    keys = "ns: {gain: {type: double, default_value: .inf, description: Of the loop}, ain: {type: bool}}\n"
    reader = reader_of(tmp_path, {"params.yaml": keys})
    place = Location("demo/params.yaml", 1)
    declared = Parameter("plugin.gain", "double", None, Access.DECLARE, place)
    node = NodeType("a", NodeKind.COMPONENT, "cpp", 2, HERE, parameters=(declared,))
    (found,) = attach(reader, reader.package, BuildModel(parameter_libraries=LIBRARIES), [Extracted(node)])
    (whole,) = found.node.parameters
    assert (whole.name, whole.type, whole.default) == ("plugin.gain", "double", ".inf")
    assert (whole.description, whole.location) == ("Of the loop", place)


def test_a_script_has_the_parameters_of_the_listener_it_constructs(tmp_path: Path) -> None:
    """A Python node has the parameters of a generated class if it constructs it, not if it only imports it."""
    use = "from demo.demo_parameters import demo_parameters\n"
    files = {**FILES, "a.py": use + "demo_parameters.ParamListener(node, 'arm')\n", "b.py": use + "ParamListener = 1\n"}
    reader = reader_of(tmp_path, files)
    scripts = [
        NodeType(name, NodeKind.SCRIPT, "python", 2, HERE, sources=(f"demo/{name}",)) for name in ("a.py", "b.py")
    ]
    build = BuildModel(parameter_libraries=LIBRARIES)
    nodes = attach(reader, reader.package, build, [Extracted(script) for script in scripts])
    assert [(n.node.name, [one.name for one in n.node.parameters]) for n in nodes] == [
        ("a.py", ["arm.gain"]),
        ("b.py", []),
    ]


def test_a_library_that_no_node_uses_is_kept_as_a_class(tmp_path: Path) -> None:
    """Declarations of a library for other packages are listed under the library's own name."""
    found = names(tmp_path, BuildModel(parameter_libraries=LIBRARIES))
    assert found == [("a", []), ("demo_parameters", ["gain"])]


def test_a_configuration_belongs_to_the_handle_of_its_server(tmp_path: Path) -> None:
    """The parameters of a dynamic_reconfigure server are in the namespace of its handle."""
    marks = (
        Mark("dynamic_reconfigure.server", HERE, "~", "demo/Demo"),
        Mark("dynamic_reconfigure.server", HERE, "~/sub", "demo/DemoConfig"),
        Mark("dynamic_reconfigure.server", HERE, "~", "elsewhere/Demo"),
        Mark("dynamic_reconfigure.server", HERE, "~"),
    )
    assert names(tmp_path, BuildModel(), *marks) == [("a", ["~/rate", "~/sub/rate"])]


def test_a_configuration_is_found_by_what_its_file_generates(tmp_path: Path) -> None:
    """A `.cfg` file of another name generates the configuration and the package in its last line."""
    files: dict[str, str | bytes] = {
        "cfg/gains.cfg": f'{CFG}exit(ParameterGenerator().generate("demo", "demo", "Gains"))\n',
        "cfg/limits.cfg": f'{CFG}exit(ParameterGenerator().generate("before", "demo", "Limits"))\n',
    }
    reader = reader_of(tmp_path, files)
    node = NodeType("a", NodeKind.COMPONENT, "cpp", 1, HERE, sources=("demo/src/a.cpp",))
    wanted = {"demo/GainsConfig": 1, "before/LimitsConfig": 1, "demo/Limits": 0, "elsewhere/Gains": 0, "demo/gains": 1}
    for name, count in wanted.items():
        mark = Mark("dynamic_reconfigure.server", HERE, "~", name)
        (found,) = attach(reader, reader.package, BuildModel(), [Extracted(node, (mark,))])
        assert (name, len(found.node.parameters)) == (name, count)


def test_code_that_shows_no_type_has_that_of_the_configuration(tmp_path: Path) -> None:
    """A parameter that code reads into a configuration has the type that its `.cfg` file states."""
    reader = reader_of(tmp_path, FILES)
    read = [Parameter(name, None, None, Access.READ, HERE) for name in ("~/rate", "rate")]
    node = NodeType("a", NodeKind.EXECUTABLE, "cpp", 1, HERE, parameters=tuple(read))
    mark = Mark("dynamic_reconfigure.server", HERE, "~", "demo/Demo")
    (found,) = attach(reader, reader.package, BuildModel(), [Extracted(node, (mark,))])
    assert [(one.name, one.type) for one in found.node.parameters[:2]] == [("~/rate", "double"), ("rate", None)]
