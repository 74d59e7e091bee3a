#pragma once
#include <rclcpp/rclcpp.hpp>

namespace blocker
{
std::shared_ptr<rclcpp::Node> make_node(const rclcpp::NodeOptions & options = rclcpp::NodeOptions());
std::shared_ptr<rclcpp::Node> make_node(
  const std::string & name, const rclcpp::NodeOptions & options = rclcpp::NodeOptions());
}  // namespace blocker
