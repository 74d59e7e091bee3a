#pragma once
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_action/rclcpp_action.hpp>

namespace servers
{
template <typename ActionT>
class SimpleServer
{
public:
  template <typename NodeT>
  explicit SimpleServer(NodeT node, const std::string & name, bool spin = false, bool quiet = false)
  : SimpleServer(node->get_node_base_interface(), node->get_node_waitables_interface(), name, spin)
  {
  }

  explicit SimpleServer(
    rclcpp::node_interfaces::NodeBaseInterface::SharedPtr base,
    rclcpp::node_interfaces::NodeWaitablesInterface::SharedPtr waitables, const std::string & name,
    bool spin = false)
  : base_(base), waitables_(waitables), name_(name)
  {
    server_ = rclcpp_action::create_server<ActionT>(
      base_, clock_, logging_, waitables_, name_, on_goal, on_cancel, on_accepted);
  }

private:
  std::string name_;
  typename rclcpp_action::Server<ActionT>::SharedPtr server_;
};
}  // namespace servers
