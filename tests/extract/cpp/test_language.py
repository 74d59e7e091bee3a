"""Language features that determine the interfaces of a program."""

from __future__ import annotations

import pytest
from extract.cpp.packages import interfaces_of, names_of

PUBLISH = "create_publisher<std_msgs::msg::String>"
METHOD = f"void go(std::string s, std::string u) {{ {PUBLISH}(s + u, 1); }}"
TYPED = """template <class M> void typed(rclcpp::Node* n) {
  if constexpr (CONDITION) n->create_publisher<M>("yes", 1); else n->create_publisher<M>("no", 1);
}
struct Base {}; struct Derived : Base {};"""
ROWS = [
    ("bound arguments", 'auto f = std::bind(&Demo::go, this, std::placeholders::_1, "y"); f("x");', METHOD, "", {"xy"}),
    ("all arguments bound", 'auto f = std::bind(&Demo::go, this, "x", "y"); f();', METHOD, "", {"xy"}),
    (
        "bound arguments of a function",
        'auto f = std::bind(make, this, std::placeholders::_1, "y"); f("x");',
        "",
        f"void make(rclcpp::Node* n, std::string s, std::string u) {{ n->{PUBLISH}(s + u, 1); }}",
        {"xy"},
    ),
    (
        "bound arguments of a callback",
        'for (std::string s : {"a", "b"}) { create_wall_timer(1s, std::bind(&Demo::go, this, s, "y")); }',
        METHOD,
        "",
        {"ay", "by"},
    ),
    (
        "global function in a method of its name",
        'go("x");',
        "void go(std::string s) { ::go(this, s); }",
        f'void go(rclcpp::Node* n, std::string s) {{ n->{PUBLISH}("free/" + s, 1); }}',
        {"free/x"},
    ),
    ("do-while, once", f'do {{ {PUBLISH}("n", 1); }} while (foreign());', "", "", {"n"}),
    ("catch after a throw", f'try {{ throw 1; }} catch (...) {{ {PUBLISH}("caught", 1); }}', "", "", {"caught"}),
    (
        "catch of what may be thrown",
        f'std::string s = "a"; try {{ s = "b"; }} catch (...) {{ s = "c"; }} {PUBLISH}(s, 1);',
        "",
        "",
        {"b", "c"},
    ),
]
CONDITIONS = [
    ("std::is_same_v<M, std_msgs::msg::String>", "std_msgs::msg::String", {"yes"}),
    ("std::is_same_v<M, std_msgs::msg::String>", "std_msgs::msg::Empty", {"no"}),
    ("std::is_same<M, std_msgs::msg::String>::value", "std_msgs::msg::String", {"yes"}),
    ("!std::is_same<M, std_msgs::msg::String>::value", "std_msgs::msg::String", {"no"}),
    ("std::is_same_v<M, int> || std::is_same_v<M, double>", "double", {"yes"}),
    ("std::is_base_of_v<Base, M>", "Derived", {"yes"}),
    ("std::is_base_of<Base, M>::value", "Base", {"yes"}),
    ("std::is_base_of_v<Derived, M>", "Base", {"no"}),
    ("std::is_base_of_v<rclcpp::Node, M>", "Demo", {"yes"}),
    ("std::is_same_v<M, Undefined>", "std_msgs::msg::String", {"yes", "no"}),
]


def names(body: str, members: str, outer: str) -> set[str | None]:
    """Return the names of the interfaces of a node with the given constructor body."""
    source = (
        f"#include <rclcpp/rclcpp.hpp>\nclass Demo;\n{outer}\nclass Demo : public rclcpp::Node {{ public:\n"
        f'Demo() : rclcpp::Node("demo") {{ {body} }}\n{members} }};\n'
        "int main(int argc, char** argv) { rclcpp::spin(std::make_shared<Demo>()); }\n"
    )
    return {one.name for one in interfaces_of(source)}


@pytest.mark.parametrize(("label", "body", "members", "outer", "wanted"), ROWS, ids=[row[0] for row in ROWS])
def test_programs_create_these_interfaces(
    label: str, body: str, members: str, outer: str, wanted: set[str | None]
) -> None:
    """The extracted interfaces are those created at run time."""
    assert names(body, members, outer) == wanted, label


@pytest.mark.parametrize(("condition", "argument", "wanted"), CONDITIONS)
def test_conditions_on_types_decide(condition: str, argument: str, wanted: set[str | None]) -> None:
    """Only the branch chosen by the types runs; both do for an unknown type."""
    assert names(f"typed<{argument}>(this);", "", TYPED.replace("CONDITION", condition)) == wanted


def test_macros_take_types() -> None:
    """The argument of a macro can be the message type."""
    source = (
        "#define MAKE(n, T, name) n->create_publisher<T>(name, 1)\n"
        'int main() { auto n = rclcpp::Node::make_shared("p"); MAKE(n, std_msgs::msg::String, "m"); }\n'
    )
    (found,) = interfaces_of(source)
    assert found.type == "std_msgs/String"


def test_untyped_braces_as_a_default_make_the_parameter() -> None:
    """`= {"~"}` constructs the type of the parameter, `= {}` one without arguments."""
    source = """#include <ros/ros.h>
#include <std_msgs/String.h>
struct Chain {
  Chain(const ros::NodeHandle& nh = {}, const ros::NodeHandle& pnh = {"~"}) : nh_(nh), pnh_(pnh) {
    in_ = nh_.advertise<std_msgs::String>("in", 1);
    out_ = pnh_.advertise<std_msgs::String>("out", 1);
  }
  ros::NodeHandle nh_, pnh_;
  ros::Publisher in_, out_;
};
int main() { Chain chain; }
"""
    assert names_of(source) == {"in", "~/out"}


def test_a_method_is_defined_through_another_name_of_its_namespace() -> None:
    """`namespace rc = robot::control;` is followed for a method defined outside its class."""
    source = """#include <ros/ros.h>
namespace robot { namespace control {
struct Drive {
  Drive();
  ros::NodeHandle nh_;
  ros::Publisher out_;
};
} }
namespace rc = robot::control;
rc::Drive::Drive() { out_ = nh_.advertise<std_msgs::String>("state", 1); }
int main(int argc, char** argv) { rc::Drive drive; }
"""
    assert names_of(source) == {"state"}
