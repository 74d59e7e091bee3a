#pragma once
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_action/rclcpp_action.hpp>
#include <std_msgs/msg/bool.hpp>

namespace arm_node
{
class Node : public rclcpp::Node
{
public:
  using rclcpp::Node::Node;

  template<typename ActionT>
  void make_server(const std::string & name)
  {
    server_ = rclcpp_action::create_server<ActionT>(this, name, nullptr, nullptr, nullptr);
  }

  double limit(const std::string & name, double otherwise)
  {
    if (!has_parameter(name)) {
      declare_parameter(name, otherwise);
    }
    return get_parameter(name).as_double();
  }

  rclcpp_action::ServerBase::SharedPtr server_;
};

// Not a node, but who calls it has what it creates.
class Monitor
{
public:
  explicit Monitor(Node * node)
  : node_(node) {}
  void watch() {watched_ = node_->create_publisher<std_msgs::msg::Bool>("watched", 1);}

private:
  Node * node_;
  rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr watched_;
};
}  // namespace arm_node
