#pragma once
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

template <typename MessageT>
class Filter {
 public:
  explicit Filter(rclcpp::Node::SharedPtr node);

 private:
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr output_;
};

#include "filters/inline/filter.hpp"
