from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from extract.manifests.building import model_of
from extract.workspaces import codes, reader_of

from kg.extract.buildmodel import PluginClass, Registration
from kg.facts import Location

if TYPE_CHECKING:
    from pathlib import Path


def plugins(root: Path, text: str, **more: str) -> list[PluginClass]:
    """Return the plugins declared by a description in plugins.xml."""
    return list(model_of(reader_of(root, {"plugins.xml": text, **more})).plugins)


def test_nodelets(tmp_path: Path) -> None:
    """A nodelet has name, class, base, library and description, and the line of its element."""
    text = """<library path="lib/libdemo_nodelets">
  <class name="demo/Edge"
         type="demo::Edge" base_class_type="nodelet::Nodelet">
    <description>Finds
      edges.</description>
  </class>
</library>"""
    assert plugins(tmp_path, text) == [
        PluginClass(
            "demo/Edge",
            "demo::Edge",
            Registration.NODELET,
            Location("demo/plugins.xml", 3),
            base_type="nodelet::Nodelet",
            library="demo_nodelets",
            description="Finds edges.",
        )
    ]


@pytest.mark.parametrize(
    ("base", "registration"),
    [
        ("nodelet::Nodelet", Registration.NODELET),
        ("rclcpp_components::NodeFactory", Registration.COMPONENT),
        ("nav_core::BaseLocalPlanner", Registration.PLUGIN),
    ],
)
def test_registration(tmp_path: Path, base: str, registration: Registration) -> None:
    """The loader of a class follows from its base class."""
    (found,) = plugins(tmp_path, f'<library path="x"><class type="a::B" base_class_type="{base}"/></library>')
    assert (found.name, found.registration, found.base_type) == ("a::B", registration, base)


ONE = '<library path="a"><class type="A"/></library>'
TWO = '<library path="b"><class type="B"/></library>'


@pytest.mark.parametrize(
    "text",
    [
        f"<class_libraries>{ONE}{TWO}</class_libraries>",
        f"{ONE}\n{TWO}",
        f'<?xml version="1.0"?>\n<!-- x -->\n{ONE}{TWO}',
    ],
)
def test_several_libraries(tmp_path: Path, text: str) -> None:
    """One file may have several libraries, with or without an enclosing element."""
    assert [(found.type, found.library) for found in plugins(tmp_path, text)] == [("A", "a"), ("B", "b")]


@pytest.mark.parametrize(
    ("path", "target"), [("lib/libcore", "core"), ("core", "core"), ("libout.so", "core"), ("libx", "x")]
)
def test_library_is_the_target(tmp_path: Path, path: str, target: str) -> None:
    """The library of a plugin is named after its target."""
    build = "add_library(core)\nset_target_properties(core PROPERTIES OUTPUT_NAME out)"
    text = f'<library path="{path}"><class type="A"/></library>'
    (found,) = plugins(tmp_path, text, **{"CMakeLists.txt": build})
    assert found.library == target


def test_templates_in_attributes(tmp_path: Path) -> None:
    """`<` in an attribute, which pluginlib's own parser accepts, is not an error."""
    text = '<library path="x"><class type="f::Mean<double>" base_class_type="f::Base<double>"/></library>'
    reader = reader_of(tmp_path, {"plugins.xml": text})
    (found,) = model_of(reader).plugins
    assert (found.type, found.base_type) == ("f::Mean<double>", "f::Base<double>")
    assert reader.problems == ()


def test_where_descriptions_are_found(tmp_path: Path) -> None:
    """Descriptions exported by package.xml or CMake, and those with a typical name, are read once each."""

    def library(name: str) -> str:
        return f'<library path="x"><class type="{name}"/></library>'

    files = {
        "package.xml": """<package format="2"><name>demo</name><export>
<nav_core plugin="${prefix}/a.xml"/><rviz plugin="$(prefix)/sub/b.xml"/><x plugin="gone.xml"/>
</export></package>""",
        "CMakeLists.txt": "pluginlib_export_plugin_description_file(nav2_core c.xml)",
        "a.xml": library("A"),
        "sub/b.xml": library("B"),
        "c.xml": library("C"),
        "my_plugins.xml": library("D"),
        "tree.xml": library("E"),
        "other_plugins.xml": "<root><class type='F'/></root>",
    }
    assert {found.type for found in model_of(reader_of(tmp_path, files)).plugins} == set("ABCD")


@pytest.mark.parametrize(
    "text",
    ["", "<library", "<library path='x'><class type='A'></library>", "<library>" * 5000, "\0<library>"],
)
def test_malformed(tmp_path: Path, text: str) -> None:
    """A malformed description is reported by name, and the others are read."""
    reader = reader_of(tmp_path, {"plugins.xml": text, "CMakeLists.txt": "add_executable(a)"})
    assert [target.name for target in model_of(reader).targets] == ["a"]
    assert {code for code, _ in codes(reader.problems)} <= {"KG112", "KG114", "KG116"}
    assert bool(reader.problems) is bool(text)
