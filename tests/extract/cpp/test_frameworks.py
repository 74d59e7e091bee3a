"""Interfaces created by calls of frameworks outside the build, as described by `ontology/calls`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from extract.cpp.packages import interfaces_of, names_of, node_of, nodes_of
from extract.workspaces import manifest

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.facts import NodeType

TYPE = "std_msgs::msg::String"


def component(body: str, members: str = "", outer: str = "", base: str = 'rclcpp::Node("demo")') -> str:
    """Return a ROS 2 program that constructs one node with the given constructor body."""
    name = base.partition("(")[0]
    return (
        f"#include <rclcpp/rclcpp.hpp>\n{outer}\nclass Demo : public {name} {{ public: Demo() : {base} {{ {body} }}\n"
        f"{members} }};\nint main(int argc, char** argv) {{ rclcpp::spin(std::make_shared<Demo>()); }}\n"
    )


def parameters_of(nodes: Iterable[NodeType]) -> list[tuple[str | None, str | None, str | None]]:
    """Return name, type and default of the parameters of some nodes, without that of the client library."""
    found = [(one.name, one.type, one.default) for node in nodes for one in node.parameters]
    return [row for row in found if "use_sim_time" not in str(row[0])]


@pytest.mark.parametrize(
    "arguments",
    [
        "this, ",
        "get_node_topics_interface(), ",
        "get_node_parameters_interface(), get_node_topics_interface(), ",
    ],
)
@pytest.mark.parametrize(
    ("function", "rest"), [("create_publisher", ""), ("create_subscription", f", [](const {TYPE}& m) {{}}")]
)
def test_free_functions_take_a_node_or_its_interfaces(arguments: str, function: str, rest: str) -> None:
    """The topic follows the node, or one or two of its interfaces."""
    source = component(f'rclcpp::{function}<{TYPE}>({arguments}"scan", 7{rest});')
    (found,) = interfaces_of(source)
    assert (found.name, found.type) == ("scan", "std_msgs/String")
    assert found.qos is not None
    assert found.qos.depth == 7


def test_marker_servers_have_topics_below_their_name() -> None:
    """An interactive marker server of ROS 2 has two topics and a service below its first argument."""
    source = component('interactive_markers::InteractiveMarkerServer server("tools", this);')
    found = {(str(item.role), item.name) for item in node_of(source).interfaces}
    assert {
        ("publishes", "tools/update"),
        ("subscribes", "tools/feedback"),
        ("services", "tools/get_interactive_markers"),
    } <= found


def test_controllers_declare_the_parameters_of_their_base_class() -> None:
    """The base class of controllers of ros2_control declares three parameters."""
    outer = "class Arm : public controller_interface::ControllerInterface { public: Arm() {} };"
    export = "PLUGINLIB_EXPORT_CLASS(Arm, controller_interface::ControllerInterface)"
    nodes = nodes_of({"arm.cpp": f"{outer}\n{export}\n"})
    assert set(parameters_of(nodes)) == {
        ("update_rate", "int", None),
        ("is_async", "bool", "false"),
        ("thread_priority", "int", "-100"),
    }


def test_the_broadcaster_of_agnocast_publishes_transforms() -> None:
    """The wrapper of Autoware around tf2 publishes /tf like tf2."""
    source = component("autoware::agnocast_wrapper::TransformBroadcaster tf(*this);")
    assert ("/tf", "tf2_msgs/TFMessage") in {(one.name, one.type) for one in node_of(source).interfaces}


def test_the_prefix_of_frames_is_a_parameter() -> None:
    """`tf::getPrefixParam` reads `tf_prefix` in the namespace of its handle."""
    node = node_of('int main() { ros::NodeHandle nh("~"); std::string p = tf::getPrefixParam(nh); }')
    assert parameters_of([node]) == [("~/tf_prefix", "string", '""')]


def test_a_parameter_object_receives_the_type_of_its_value() -> None:
    """`get_parameter(name, object)` into a Boolean `rclcpp::Parameter` reads a Boolean."""
    source = component('rclcpp::Parameter given("fast", true); get_parameter("fast", given);')
    assert parameters_of([node_of(source)]) == [("fast", "bool", "true")]


@pytest.mark.parametrize("local", ["double r = 25;", "double r; r = 25;", "double r{25};"])
def test_a_default_has_the_type_of_its_variable(local: str) -> None:
    """A parameter whose default is a floating-point variable is floating point, even for an integral value."""
    source = component(f'{local} declare_parameter("range", r);')
    assert parameters_of([node_of(source)]) == [("range", "double", "25.0")]


def test_a_base_without_initialiser_is_at_the_head_of_the_class() -> None:
    """Declarations of a framework's base class have the line of the class if no initialiser names the base."""
    header = "\n\nclass Arm : public controller_interface::ControllerInterface { public: Arm(); };\n"
    export = "PLUGINLIB_EXPORT_CLASS(Arm, controller_interface::ControllerInterface)"
    source = f'#include "arm.hpp"\n\n\n\n\nArm::Arm() {{}}\n{export}\n'
    (node,) = nodes_of({"arm.cpp": source, "arm.hpp": header})
    assert {(one.location.path, one.location.line) for one in node.parameters} == {("demo/arm.hpp", 3)}


def test_a_parameter_is_at_its_first_access() -> None:
    """A parameter tested before it is read with a default has the line of the test."""
    lines = ["int main() {", 'ros::NodeHandle nh("~");', 'bool set = nh.hasParam("x");', "", "", "", "int x;"]
    node = node_of("\n".join([*lines, 'nh.param("x", x, 3); }']))
    assert [(p.location.line, p.default) for p in node.parameters if p.name == "~/x"] == [(3, "3")]


def test_a_callback_in_a_field_of_options_is_called() -> None:
    """A framework calls the functions in the options it receives: here a lazy subscription."""
    body = f"""rclcpp::PublisherOptions options;
      options.event_callbacks.matched_callback = [this](rclcpp::MatchedInfo &) {{
        if (!camera_) camera_ = image_transport::create_camera_subscription(this, "image", nullptr, "raw");
        subscription_ = create_subscription<{TYPE}>("in", 1, [](const {TYPE} & message) {{}});
      }};
      publisher_ = create_publisher<{TYPE}>("out", 1, options);"""
    members = f"""rclcpp::Publisher<{TYPE}>::SharedPtr publisher_;
      rclcpp::Subscription<{TYPE}>::SharedPtr subscription_;
      image_transport::CameraSubscriber camera_;"""
    assert {(str(one.role), one.name) for one in interfaces_of(component(body, members))} == {
        ("publishes", "out"),
        ("subscribes", "in"),
        ("subscribes", "image"),
        ("subscribes", "camera_info"),
    }


def test_options_hold_the_interface_that_their_constructor_gives() -> None:
    """`advertise(options)` creates it, with the type named by the constructor."""
    source = """#include <ros/ros.h>
int main(int argc, char** argv) {
  ros::NodeHandle nh("~");
  ros::AdvertiseOptions options("output", 1, "*", "std_msgs/String", "", connected, connected);
  ros::Publisher out = nh.advertise(options);
}
"""
    (found,) = interfaces_of(source)
    assert (found.name, found.type, found.location.line) == ("~/output", "std_msgs/String", 4)


def test_a_nodelet_has_what_its_virtual_methods_create() -> None:
    """A base class helper that the nodelet does not call creates nothing."""
    source = """#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.h>
#include <std_msgs/String.h>
class Base : public nodelet::Nodelet {
protected:
  void advertiseText(ros::NodeHandle& nh, const std::string& topic) { nh.advertise<std_msgs::String>(topic, 1); }
};
class Viewer : public Base {
  virtual void onInit() { getPrivateNodeHandle().advertise<std_msgs::String>("out", 1); }
};
PLUGINLIB_EXPORT_CLASS(Viewer, nodelet::Nodelet)
"""
    assert names_of(source, {"CMakeLists.txt": "project(demo)\nadd_library(demo main.cpp)\n"}) == {"~/out"}


def test_a_function_that_formats_gives_a_text_with_holes() -> None:
    """Unknown numbers are holes."""
    source = """#include <ros/ros.h>
#include <std_msgs/String.h>
int main(int argc, char** argv) {
  ros::NodeHandle nh;
  for (int i = 0; i < argc; ++i) nh.advertise<std_msgs::String>(uFormat("image%d/%s", i, "raw"), 1);
}
"""
    assert names_of(source) == {"image{}/raw"}


def test_an_element_of_a_list_parameter_names_the_parameter() -> None:
    """The list is empty by default, or has elements that launch files can replace."""
    source = """#include <rclcpp/rclcpp.hpp>
int main(int argc, char** argv) {
  rclcpp::Node node("demo");
  auto topics = node.declare_parameter("topics", std::vector<std::string>%s);
  for (size_t i = 0; i < argc; ++i) node.create_publisher<std_msgs::msg::String>(topics.at(i), 1);
}
"""
    found = [interfaces_of(source % given) for given in ("()", '{"a", "b"}')]
    assert [{(one.name, one.parameter) for one in each} for each in found] == [
        {(None, "topics[]")},
        {("a", "topics[]"), ("b", "topics[]")},
    ]


def test_a_class_of_the_call_specifies_an_interface() -> None:
    """The adaptor of Autoware takes it as a template argument, or from its output."""
    specification = """struct State {
  using Message = std_msgs::msg::String;
  static constexpr char name[] = "/state";
};"""
    body = "adaptor_.create_publisher<State>(); adaptor_.init_sub(sub_, [](auto message) {});"
    members = """autoware::component_interface_utils::NodeAdaptor<rclcpp::Node> adaptor_{this};
autoware::component_interface_utils::Subscription<State>::SharedPtr sub_;"""
    found = interfaces_of(component(body, members, specification))
    assert [(one.role, one.name, one.type) for one in found] == [
        ("publishes", "/state", "std_msgs/String"),
        ("subscribes", "/state", "std_msgs/String"),
    ]


def test_a_base_outside_of_the_build_holds_the_node_handle() -> None:
    """The name of the member shows whether it is a private one."""
    source = """#include <octomap_server/OctomapServer.h>
class Contact : public octomap_server::OctomapServer {
public:
  Contact() {
    m_nh.advertise<std_msgs::String>("map", 1);
    pnh_.subscribe<std_msgs::String>("points", 1, &Contact::received, this);
    list_.advertise("nothing");
  }
  std::list<int> list_;
};
int main(int argc, char** argv) { Contact contact; }
"""
    assert names_of(source) == {"map", "~/points"}


def test_what_a_framework_makes_has_the_calls_that_led_to_it() -> None:
    """The evidence of an implicit interface is the call in the node, followed by that in another package's wrapper."""
    wrapper = (
        "struct Wrapper {\n  explicit Wrapper(rclcpp::Node* n)\n  : updater_(n) {}\n"
        "  diagnostic_updater::Updater updater_;\n};\n"
    )
    source = component("Wrapper wrapper(this);", outer="#include <shared/wrapper.hpp>")
    more = {"../shared/package.xml": manifest("shared"), "../shared/include/shared/wrapper.hpp": wrapper}
    (found,) = [one for one in node_of(source, more).interfaces if one.name == "/diagnostics"]
    assert (found.location.path, found.location.line) == ("demo/main.cpp", 3)
    assert [(one.path, one.line) for one in found.via] == [("shared/include/shared/wrapper.hpp", 3)]


def test_an_abstract_class_is_not_a_node() -> None:
    """Derived classes name its topic; a concrete class is a node."""
    classes = """#include <rclcpp/rclcpp.hpp>
class Base {
public:
  explicit Base(rclcpp::Node * node) {
    node->create_publisher<std_msgs::msg::String>("out", 1);
    node->create_publisher<std_msgs::msg::String>(name(), 1);
  }
  virtual std::string name() = 0;
};
class Whole {
public:
  explicit Whole(rclcpp::Node * node) { node->create_publisher<std_msgs::msg::String>("whole", 1); }
};
"""
    found = nodes_of({"classes.cpp": classes, "CMakeLists.txt": "project(demo)\nadd_library(demo classes.cpp)\n"})
    assert [one.name for one in found] == ["Whole"]


def test_a_plugin_of_rqt_has_the_handles_of_a_nodelet() -> None:
    """The framework calls `initPlugin`, and the plugin has the methods of its base class."""
    plugin = """class Plot : public rqt_gui_cpp::Plugin {
  void initPlugin(qt_gui_cpp::PluginContext& context) override {
    input_ = getPrivateNodeHandle().subscribe("data", 1, &Plot::read, this);
  }
  void read(const std_msgs::Float64ConstPtr& message) {}
  ros::Subscriber input_;
};
PLUGINLIB_EXPORT_CLASS(Plot, rqt_gui_cpp::Plugin)
"""
    (node,) = nodes_of({"plot.cpp": plugin})
    assert [(one.name, one.type) for one in node.interfaces if not one.implicit] == [("~/data", "std_msgs/Float64")]
