#pragma once
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

namespace camera
{
namespace bridge
{
struct Sender
{
  Sender(rclcpp::Node::SharedPtr node, const std::string& name)
  {
    publisher = node->create_publisher<std_msgs::msg::String>(name, 1);
  }
  std::shared_ptr<void> publisher;
};

inline auto listen(rclcpp::Node::SharedPtr node, const std::string& name)
{
  return node->create_subscription<std_msgs::msg::String>(name, 1, [](std_msgs::msg::String) {});
}
}  // namespace bridge
namespace old_bridge = bridge;
}  // namespace camera

namespace short_name = camera::bridge;
namespace messages = std_msgs::msg;
