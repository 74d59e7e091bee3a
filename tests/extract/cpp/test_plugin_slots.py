"""Plugin slots from calls that load plugins: the origins of base class, class and name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from extract.cpp.packages import node_of
from extract.workspaces import manifest, written

from kg.corpus.reading import Reader
from kg.extract.package import extract_package

if TYPE_CHECKING:
    from pathlib import Path

    from kg.facts import PluginSlot

ROWS = """
[[class]]
name = "acme::Loader"
slot = { base = "{1}" }

[[call]]
on = ["acme::Loader"]
name = "load"
arguments = [1, 2]
slot = { class = 0, name = 1 }

[[call]]
in = ["acme"]
name = "load_all"
arguments = [1, 1]
slot = { base = "acme::Filter", names = "{0}.names", parameter = "{0}.{id}.class" }
"""
CMAKE = "cmake_minimum_required(VERSION 3.8)\nproject(demo)\nadd_executable(demo main.cpp)\n"


def program(body: str) -> str:
    """Return a ROS 2 program with the node `node` and some statements."""
    return f'int main(int argc, char** argv) {{\nrclcpp::Node node("demo");\n{body}\n}}\n'


def slots_of(body: str) -> list[PluginSlot]:
    """Return the slots of a program with some statements."""
    return list(node_of(program(body)).slots)


def test_the_first_template_argument_is_the_base_class() -> None:
    """A loader with an unseen constructor, or without a base class argument, is typed by its template."""
    (slot,) = slots_of('class_loader::ClassLoader loader("x.so"); loader.createInstance<acme::Filter>("acme::Mean");')
    assert (slot.base_class, slot.fixed, slot.defaults[0].class_name) == ("acme::Filter", True, "acme::Mean")


def test_one_slot_has_all_classes_that_the_code_gives() -> None:
    """Classes of one base class that no parameter gives are defaults of one slot, each once."""
    calls = " ".join(f'loader.createInstance("acme::{name}");' for name in ("Mean", "Median", "Mean"))
    (slot,) = slots_of(f'pluginlib::ClassLoader<acme::Filter> loader("acme", "acme::Filter"); {calls}')
    assert [one.class_name for one in slot.defaults] == ["acme::Mean", "acme::Median"]


def test_a_class_from_elsewhere_has_a_reason() -> None:
    """A class given neither by the code nor by a parameter is unknown, and the slot is not fixed."""
    (slot,) = slots_of(
        'pluginlib::ClassLoader<acme::Filter> loader("acme", "acme::Filter"); loader.createInstance("acme::Mean");'
        "loader.createInstance(read_from_disk());"
    )
    assert (slot.fixed, slot.parameter) == (False, None)
    assert "read_from_disk" in (slot.reason or "")


@pytest.mark.parametrize("default", ['"mean"', 'std::vector<std::string>{"mean", "other"}'])
def test_a_parameter_names_the_plugins(default: str) -> None:
    """A parameter whose default is a plugin's name gives the names: a text or a list."""
    (slot,) = slots_of(f"""node.declare_parameter("filters", {default});
      node.declare_parameter("mean.type", "acme::Mean");
      pluginlib::ClassLoader<acme::Filter> loader("acme", "acme::Filter");
      loader.createInstance(node.get_parameter("mean.type").as_string());""")
    assert (slot.names, slot.parameter) == ("filters", "{id}.type")
    assert [(one.name, one.class_name) for one in slot.defaults] == [("mean", "acme::Mean")]


def test_elements_of_a_list_can_be_the_classes() -> None:
    """A list parameter may contain the classes themselves."""
    (slot,) = slots_of("""pluginlib::ClassLoader<acme::Filter> loader("acme", "acme::Filter");
      for (auto kind : node.declare_parameter("filters", std::vector<std::string>{})) loader.createInstance(kind);""")
    assert (slot.names, slot.parameter, slot.defaults) == ("filters", "filters[]", ())


def test_users_describe_loaders_of_their_own(tmp_path: Path) -> None:
    """Rows with `slot` in a user's file count like shipped ones."""
    body = (
        'acme::Loader loader(&node, "acme::Planner"); loader.load("acme::Fast", "fast"); acme::load_all("chain");\n'
        'node.create_publisher<std_msgs::msg::String>("out", 1);'
    )
    files: dict[str, str | bytes] = {
        "demo/package.xml": manifest("demo"),
        "demo/CMakeLists.txt": CMAKE,
        "demo/main.cpp": program(body),
    }
    workspace = written(tmp_path, files)
    package = workspace.package("demo")
    assert package is not None
    (node,) = extract_package(Reader(workspace, *workspace.folder(package)), (ROWS,)).nodes
    found = {slot.base_class: slot for slot in node.slots}
    assert [(one.name, one.class_name) for one in found["acme::Planner"].defaults] == [("fast", "acme::Fast")]
    assert (found["acme::Filter"].names, found["acme::Filter"].parameter) == ("chain.names", "chain.{id}.class")
