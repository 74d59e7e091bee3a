#pragma once
#include "filters/filter.hpp"

template <typename MessageT>
Filter<MessageT>::Filter(rclcpp::Node::SharedPtr node) {
  output_ = node->create_publisher<std_msgs::msg::String>("filtered", 1);
}
