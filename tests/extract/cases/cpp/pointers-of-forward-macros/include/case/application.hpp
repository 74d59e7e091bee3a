#pragma once
#include <rclcpp/rclcpp.hpp>

namespace application
{
class Application
{
public:
  const rclcpp::Node::SharedPtr& getNode() const;
};
}  // namespace application
