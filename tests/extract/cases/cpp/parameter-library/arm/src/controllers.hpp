#pragma once
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>
#include "arm_parameters.hpp"

class Controller
{
public:
  explicit Controller(rclcpp::Node* node);

private:
  std::shared_ptr<arm::ParamListener> listener_;
  arm::Params params_;
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr publisher_;
};
