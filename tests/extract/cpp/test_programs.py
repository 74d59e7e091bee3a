"""Programs that only start a component have the declarations of the component, which runs once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from extract.cpp.packages import nodes_of

from kg.extract.cpp.construction import Constructions

if TYPE_CHECKING:
    from kg.facts import NodeType

_BUILD = """cmake_minimum_required(VERSION 3.8)
project(demo)
add_library(viewer SHARED viewer.cpp)
rclcpp_components_register_nodes(viewer "demo::Viewer")
add_executable(demo main.cpp)
target_link_libraries(demo viewer)
"""
_HEADER = """#include <rclcpp/rclcpp.hpp>
namespace demo {
class Viewer : public rclcpp::Node {
public:
  explicit Viewer(const rclcpp::NodeOptions & options = rclcpp::NodeOptions());
  virtual void late();
};
}
"""
_SOURCE = """#include "viewer.hpp"
#include <rclcpp_components/register_node_macro.hpp>
namespace demo {
Viewer::Viewer(const rclcpp::NodeOptions & options) : Node("viewer", options) {
  declare_parameter("rate", 10);
  create_publisher<std_msgs::msg::String>("out", 1);
}
void Viewer::late() { LATE }
}
RCLCPP_COMPONENTS_REGISTER_NODE(demo::Viewer)
"""
_MAIN = """#include "viewer.hpp"
int main(int argc, char ** argv) {
  rclcpp::init(argc, argv);
  auto node = std::make_shared<demo::Viewer>();
  MORE
  rclcpp::spin(node->get_node_base_interface());
  rclcpp::shutdown();
  return 0;
}
"""
_PUBLISHES = 'node->create_publisher<std_msgs::msg::String>("more", 1);'
_LATER = 'create_publisher<std_msgs::msg::String>("late", 1);'


def _nodes(more: str, late: str = "") -> tuple[NodeType, ...]:
    source, main = _SOURCE.replace("LATE", late), _MAIN.replace("MORE", more)
    return nodes_of({"CMakeLists.txt": _BUILD, "viewer.hpp": _HEADER, "viewer.cpp": source, "main.cpp": main})


def _names(node: NodeType) -> list[str]:
    return sorted(one.name or "" for one in node.interfaces if not one.implicit)


@pytest.mark.parametrize("late", ["", _LATER])
def test_a_program_that_only_starts_a_component_has_the_facts_of_a_run(late: str) -> None:
    """A call of another function disables the shortcut, although it declares nothing."""
    assert _nodes("", late) == _nodes('std::puts("");', late)


def test_a_component_and_the_program_that_only_starts_it_are_one_node() -> None:
    """The node has the name of the executable."""
    (node,) = _nodes("")
    assert (node.executable, node.plugin, _names(node)) == ("demo", "demo::Viewer", ["out"])


def test_a_component_runs_once_for_itself_and_its_program(monkeypatch: pytest.MonkeyPatch) -> None:
    """A program that only starts a component does not run again."""
    begun: list[str] = []
    initialise = Constructions.initialise

    def counted(self: Constructions, *arguments: object, **named: object) -> None:
        begun.append(str(getattr(arguments[1], "name", "")))
        initialise(self, *arguments, **named)  # type: ignore[arg-type] # handed on as they came

    monkeypatch.setattr(Constructions, "initialise", counted)
    _nodes("")
    assert begun.count("Viewer") == 1


def test_a_program_that_declares_more_than_its_component_is_a_node_of_its_own() -> None:
    """It publishes on one more topic."""
    assert sorted(map(_names, _nodes(_PUBLISHES))) == [["more", "out"], ["out"]]


def test_a_program_does_not_have_what_only_the_loader_of_a_component_calls() -> None:
    """The loader may call virtual methods."""
    assert sorted(map(_names, _nodes("", _LATER))) == [["late", "out"], ["out"]]
