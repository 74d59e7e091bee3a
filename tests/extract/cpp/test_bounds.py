"""Limits of interpretation are recorded with the affected node."""

from __future__ import annotations

import pytest
from extract.cpp.packages import node_of

LOOP = """#include <ros/ros.h>
#include <std_msgs/String.h>
int main(int argc, char** argv)
{
  ros::NodeHandle nh;
  ros::Publisher all = nh.advertise<std_msgs::String>("all", 1);
  for (int i = 0; i < %d; ++i)
    %s("topic" + std::to_string(i), 1);
}
"""
ADVERTISE = "nh.advertise<std_msgs::String>"


def test_a_loop_that_creates_interfaces_and_goes_on_is_cut_short() -> None:
    """The limit is recorded with the line of the current function."""
    (bound,) = node_of(LOOP % (1000, ADVERTISE)).bounds
    assert (bound.limit, bound.location.path, bound.location.line) == ("turns", "demo/main.cpp", 3)


@pytest.mark.parametrize(("turns", "call"), [(5, ADVERTISE), (1000, "print")])
def test_a_loop_that_ends_or_creates_nothing_is_no_bound(turns: int, call: str) -> None:
    """The limit of iterations counts only if interfaces may be missing."""
    assert node_of(LOOP % (turns, call)).bounds == ()


def test_a_function_that_declares_once_runs_again() -> None:
    """A helper whose first parameter was declared many times still declares another one."""
    source = """#include <rclcpp/rclcpp.hpp>
void ensure(rclcpp::Node & node, std::string name) { if (!node.has_parameter(name)) node.declare_parameter(name, 1); }
int main(int argc, char** argv)
{
  rclcpp::Node node("demo");
  %s
  ensure(node, "last");
}
"""
    found = node_of(source % ('ensure(node, "first");\n' * 20)).parameters
    assert [one.name for one in found if "use_sim_time" not in str(one.name)] == ["first", "last"]


def test_loops_that_create_nothing_leave_steps_for_what_follows() -> None:
    """A table filled by nested loops does not prevent the run from reaching the publisher after it."""
    loops = "".join(f"for (int {name} = 0; {name} != 60; ++{name}) " for name in "ijk")
    source = f"""#include <ros/ros.h>
#include <std_msgs/String.h>
int main(int argc, char** argv)
{{
  ros::NodeHandle nh;
  int sum = 0;
  {loops} {{ sum += i * j * k; sum += i + j + k; sum += 1; }}
  ros::Publisher all = nh.advertise<std_msgs::String>("all", 1);
}}
"""
    node = node_of(source)
    assert [one.name for one in node.interfaces if not one.implicit] == ["all"]
    assert node.bounds == ()


def test_a_pointer_by_another_name_does_not_construct_its_class() -> None:
    """Structures that point to each other are constructed once."""
    source = """#include <ros/ros.h>
#include <std_msgs/String.h>
struct Vertex;
struct Edge;
typedef Vertex * VertexPtr;
typedef Edge * EdgePtr;
struct Vertex { EdgePtr first{nullptr}; EdgePtr second{nullptr}; };
struct Edge { VertexPtr start{nullptr}; VertexPtr end{nullptr}; };
int main(int argc, char** argv)
{
  ros::NodeHandle nh;
  Vertex vertex;
  ros::Publisher all = nh.advertise<std_msgs::String>("all", 1);
}
"""
    node = node_of(source)
    assert [one.name for one in node.interfaces if not one.implicit] == ["all"]
    assert node.bounds == ()
