"""Writes in one branch are visible after it, even if it leaves the loop or the function."""

from __future__ import annotations

import pytest
from extract.cpp.packages import names_of, node_of, texts_of

FACTORY = """#include <ros/ros.h>
#include <std_msgs/String.h>
struct Display {
  Display(ros::NodeHandle& nh, const std::string& name) : nh_(nh), name_(name) {}
  virtual void start() = 0;
  ros::NodeHandle& nh_;
  std::string name_;
  ros::Publisher out_;
};
struct Map : Display {
  using Display::Display;
  void start() override { out_ = nh_.advertise<std_msgs::String>(name_ + "/map", 1); }
};
struct Cloud : Display {
  using Display::Display;
  void start() override { out_ = nh_.advertise<std_msgs::String>(name_ + "/cloud", 1); }
};
std::shared_ptr<Display> create(ros::NodeHandle& nh, const std::string& kind) {
  if (kind == "map") return std::shared_ptr<Display>(new Map(nh, "a"));
  if (kind == "cloud") return std::shared_ptr<Display>(new Cloud(nh, "b"));
  return std::shared_ptr<Display>();
}
int main(int argc, char** argv) {
  ros::NodeHandle nh;
  std::shared_ptr<Display> display = create(nh, argv[1]);
  display->start();
}
"""


def test_a_factory_that_returns_from_branches_makes_whole_objects() -> None:
    """Each object has the values written by its constructor."""
    assert names_of(FACTORY) == {"a/map", "b/cloud"}


@pytest.mark.parametrize("end", ["break", "continue"])
def test_a_value_set_before_a_loop_ends_early_is_one_of_its_values(end: str) -> None:
    """The value before the loop is one of the alternatives."""
    loop = f'std::string name = "none"; for (int i = 0; i < argc; ++i) {{ if (found(i)) {{ name = "one"; {end}; }} }}'
    assert texts_of("name", loop) == {"none", "one"}


def test_a_field_set_before_a_function_returns_early_keeps_the_value() -> None:
    """Both paths through the function count."""
    outer = """struct Names {
  void read(bool simulated) { if (simulated) { name = "simulated"; return; } name = "real"; }
  std::string name;
};"""
    assert texts_of("names.name", "Names names; names.read(ask());", outer) == {"simulated", "real"}


def test_an_element_is_set_through_at() -> None:
    """`at()` accesses the element, like brackets."""
    assert texts_of("names.at(1)", 'std::vector<std::string> names{"a", "b"}; names.at(1) = "c";') == {"c"}


def test_a_function_that_fills_a_container_runs_as_often_as_it_is_called() -> None:
    """The function itself declares nothing."""
    source = """#include <rclcpp/rclcpp.hpp>
void add(std::map<std::string, int> & all, const std::string & name) { all[name] = 0; }
int main(int argc, char** argv) {
  rclcpp::Node node("demo");
  std::map<std::string, int> all;
  %s
  node.declare_parameters("", all);
}
"""
    names = [f"p{number}" for number in range(9)]
    found = node_of(source % " ".join(f'add(all, "{name}");' for name in names)).parameters
    assert [one.name for one in found if one.name in names] == names


def test_a_copy_constructor_that_is_defaulted_does_not_start_a_component() -> None:
    """The loader passes the options of a node."""
    source = """#include <rclcpp/rclcpp.hpp>
#include <rclcpp_components/register_node_macro.hpp>
class Viewer : public rclcpp::Node {
public:
  explicit Viewer(const Viewer &) = default;
  explicit Viewer(const rclcpp::NodeOptions & options) : Node("viewer", options) {
    create_publisher<std_msgs::msg::String>("out", 1);
  }
};
RCLCPP_COMPONENTS_REGISTER_NODE(Viewer)
"""
    build = "project(demo)\nadd_library(demo SHARED main.cpp)\n"
    assert names_of(source, {"CMakeLists.txt": build}) == {"out"}


def test_a_function_that_returns_false_on_failure_can_succeed() -> None:
    """The caller's code after a success counts, although the result of a success is unknown."""
    outer = """bool prepare() { if (!connect()) return false; return finish(); }
void* load() { if (!prepare()) return nullptr; return read(); }"""
    local = 'std::string name = "none"; if (!prepare()) return 1; if (!load()) return 1; name = "one";'
    assert texts_of("name", local, outer) == {"one"}


@pytest.mark.parametrize(("default", "names"), [("", set()), (', "used"', {"used"})])
def test_an_interface_whose_name_stays_empty_does_not_exist(default: str, names: set[str]) -> None:
    """The code tests a name for emptiness that a function may have set."""
    source = """#include <rclcpp/rclcpp.hpp>
void choose(std::string & name, const std::string & given = "") { if (ask()) { name = given; } }
int main(int argc, char** argv) {
  rclcpp::Node node("demo");
  std::string name;
  choose(name%s);
  if (!name.empty()) { node.create_publisher<std_msgs::msg::String>(name, 1); }
  node.create_client<std_srvs::srv::Empty>("end");
}
"""
    assert names_of(source % default) == names | {"end"}


def test_a_parameter_without_default_reaches_the_caller_through_a_reference() -> None:
    """The text before the call is discarded."""
    source = """#include <rclcpp/rclcpp.hpp>
void read(rclcpp::Node & node, std::string & topic) { topic = node.declare_parameter<std::string>("topic"); }
int main(int argc, char** argv) {
  rclcpp::Node node("demo");
  std::string topic = "none";
  read(node, topic);
  node.create_publisher<std_msgs::msg::String>(topic, 1);
}
"""
    (found,) = [one for one in node_of(source).interfaces if not one.implicit]
    assert (found.name, found.parameter) == (None, "topic")


def test_a_subscriber_may_be_null() -> None:
    """It is an object, and null until it has a topic."""
    source = """#include <ros/ros.h>
void called(const std_msgs::String& message) {}
int main(int argc, char** argv) {
  ros::NodeHandle nh;
  ros::Subscriber sub;
  if (sub == NULL) sub = nh.subscribe("topic", 1, called);
}
"""
    assert names_of(source) == {"topic"}


@pytest.mark.parametrize("start", ["0", "nullptr", "NULL"])
def test_what_code_outside_the_sources_writes_by_address_is_unknown(start: str) -> None:
    """Testing the result does not end the function that creates the interface."""
    body = f"""addrinfo* info = {start};
  if (getaddrinfo("host", "port", 0, &info) != 0 || !info) {{ throw std::runtime_error("no host"); }}
  ros::NodeHandle nh;
  auto out = nh.advertise<std_msgs::String>("status", 1);"""
    assert names_of(f"int main(int argc, char** argv) {{ {body} }}") == {"status"}
