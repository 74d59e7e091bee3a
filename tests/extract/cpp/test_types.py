from __future__ import annotations

import pytest
from extract.cpp.packages import interfaces_of, type_of
from hypothesis import given
from hypothesis import settings as bounded
from hypothesis import strategies as st

PACKAGES = st.sampled_from(["sensor_msgs", "my_robot_msgs", "a1_msgs"])
NAMES = st.sampled_from(["Image", "PointCloud2", "TF", "RGBDImage", "A", "Feedback", "Result", "Goal"])
WRAPPINGS = st.sampled_from(
    [
        "{0}",
        "const {0}&",
        "{0}::ConstPtr",
        "const {0}::ConstPtr&",
        "{0}ConstPtr",
        "{0}Ptr",
        "boost::shared_ptr<{0} const>",
        "const boost::shared_ptr<const {0}>&",
        "std::shared_ptr<{0}>",
        "std::unique_ptr<{0}>",
        "ros::MessageEvent<{0} const>",
        "{0}::SharedPtr",
        "{0}::ConstSharedPtr",
        "{0}::UniquePtr",
    ]
)


@bounded(max_examples=80, deadline=None)
@given(PACKAGES, NAMES, st.sampled_from(["{0}::{1}", "{0}::msg::{1}", "::{0}::{1}"]), WRAPPINGS)
def test_messages_are_known_in_every_spelling(package: str, name: str, scope: str, wrapping: str) -> None:
    """Pointers, references, events and `const` around a message type are removed, for any name."""
    assert type_of(wrapping.format(scope.format(package, name))) == f"{package}/{name}"


@bounded(max_examples=40, deadline=None)
@given(PACKAGES, NAMES, st.integers(1, 6))
def test_aliases_are_followed(package: str, name: str, steps: int) -> None:
    """Chains of `using` and `typedef` lead to the message."""
    chain = "".join(f"using T{i} = T{i - 1};\n" if i % 2 else f"typedef T{i - 1} T{i};\n" for i in range(1, steps + 1))
    assert type_of(f"T{steps}", f"using T0 = {package}::{name};\n{chain}") == f"{package}/{name}"


def test_names_without_package_are_found_by_include() -> None:
    """A message named through `using namespace` belongs to the package whose header is included."""
    ros1 = "#include <sensor_msgs/Image.h>\nusing namespace sensor_msgs;"
    ros2 = "#include <sensor_msgs/msg/point_cloud2.hpp>\nusing namespace sensor_msgs::msg;"
    assert type_of("Image", ros1) == "sensor_msgs/Image"
    assert type_of("PointCloud2", ros2) == "sensor_msgs/PointCloud2"


def test_other_classes_are_no_messages() -> None:
    """Numbers and strings are not interface types."""
    assert type_of("int") is None
    assert type_of("std::string") is None


def test_clouds_of_pcl_are_published_as_messages() -> None:
    """`pcl_ros` sends a cloud of any point type as one message."""
    assert type_of("pcl::PointCloud<pcl::PointXYZ>") == "sensor_msgs/PointCloud2"


def test_adapters_are_of_the_message_that_is_sent() -> None:
    """The type sent by `rclcpp::TypeAdapter` is its second argument."""
    used = "using Text = rclcpp::TypeAdapter<std::string, std_msgs::msg::String>;"
    source = f'{used}\nint main() {{ rclcpp::Node node("n"); node.create_publisher<Text>("t", 1); }}'
    (found,) = interfaces_of(source)
    assert found.type == "std_msgs/String"


def test_aliases_that_name_themselves_end() -> None:
    """Circular aliases terminate."""
    assert type_of("T", "using T = U;\nusing U = T;") in (None, "T", "U")


IMAGE = "sensor_msgs::msg::Image"
ADAPTER = (
    f"template <> struct rclcpp::TypeAdapter<space::Frame, {IMAGE}> {{\n"
    f"  using custom_type = space::Frame; using ros_message_type = {IMAGE};\n"
    "  static void convert_to_ros_message(const custom_type& from, ros_message_type& to) {}\n};\n"
)
STATED = f"RCLCPP_USING_CUSTOM_TYPE_AS_ROS_MESSAGE_TYPE(\n  space::Frame, {IMAGE});\n"
ADAPTERS = [
    ("", f"rclcpp::TypeAdapter<space::Frame, {IMAGE}>"),
    (ADAPTER, f"rclcpp::TypeAdapter<space::Frame, {IMAGE}>"),
    ("", f"rclcpp::adapt_type<space::Frame>::as<{IMAGE}>"),
    ("", f"rclcpp::adapt_type<cv::Mat>::as<{IMAGE}>"),
    (STATED, "space::Frame"),
    (ADAPTER + STATED, "space::Frame"),
    (f"RCLCPP_USING_CUSTOM_TYPE_AS_ROS_MESSAGE_TYPE(cv::Mat, {IMAGE});\n", "cv::Mat"),
]
USES = [
    ('create_publisher<{}>("t", 1);', ""),
    ('using Sent = {}; create_publisher<Sent>("t", 1);', ""),
    ('typedef {} Sent; create_publisher<Sent>("t", 1);', ""),
    ('create_publisher<Sent>("t", 1);', "using Sent = {};"),
    ('rclcpp::create_publisher<{}>(this, "t", 1);', ""),
]


@pytest.mark.parametrize(("stated", "kind"), ADAPTERS)
@pytest.mark.parametrize(("use", "named"), USES)
def test_adapters_stand_for_their_message(stated: str, kind: str, use: str, named: str) -> None:
    """A type sent as a message by an adapter has the type of the message, for any form of the adapter."""
    source = (
        f"#include <rclcpp/rclcpp.hpp>\nnamespace space {{ class Frame {{}}; }}\n{stated}{named.format(kind)}\n"
        f'class Demo : public rclcpp::Node {{ public: Demo() : rclcpp::Node("demo") {{ {use.format(kind)} }} }};\n'
        "int main(int argc, char** argv) { rclcpp::spin(std::make_shared<Demo>()); }\n"
    )
    (found,) = interfaces_of(source)
    assert found.type == "sensor_msgs/Image"


def test_a_callback_takes_the_adapted_type() -> None:
    """The parameter of a callback gives the message, too."""
    assert type_of("const space::Frame&", "namespace space { class Frame {}; }\n" + STATED) == "sensor_msgs/Image"


def test_classes_of_the_build_are_no_messages() -> None:
    """A class defined in the sources has no message type unless an adapter gives one."""
    assert type_of("space::Thing", "namespace space { class Thing {}; }") is None


def test_an_alias_of_a_class_template_has_its_types() -> None:
    """`Sub` is the subscriber of the class template's message argument."""
    source = """#include <rclcpp/rclcpp.hpp>
template <typename Msg>
struct Pair {
  using Sub = message_filters::Subscriber<Msg>;
  Pair(rclcpp::Node * node, const std::string & name) { sub_ = std::make_shared<Sub>(node, name); }
  std::shared_ptr<Sub> sub_;
};
int main(int argc, char** argv) {
  rclcpp::Node node("demo");
  Pair<sensor_msgs::msg::Image> pair(&node, "image");
}
"""
    (found,) = interfaces_of(source)
    assert (found.name, found.type) == ("image", "sensor_msgs/Image")


def test_a_callback_of_a_class_template_has_the_types_of_the_object() -> None:
    """`&T<S>::serve` is the method of the current object, where `S` is known."""
    source = """#include <ros/ros.h>
template <typename S> struct Server {
  explicit Server(ros::NodeHandle& nh) {
    service = nh.advertiseService("bound", &Server<S>::serve, this);
    input = nh.subscribe("in", 1, &Server<S>::read, this);
  }
  bool serve(typename S::Request& request, typename S::Response& response) { return true; }
  void read(const typename S::ConstPtr& message) {}
  ros::ServiceServer service;
  ros::Subscriber input;
};
int main(int argc, char** argv) { ros::NodeHandle nh; Server<std_srvs::SetBool> server(nh); }
"""
    assert {item.name: item.type for item in interfaces_of(source)} == {
        "bound": "std_srvs/SetBool",
        "in": "std_srvs/SetBool",
    }
