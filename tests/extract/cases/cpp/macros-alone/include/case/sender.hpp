#pragma once

#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

enum Kind
{
  KIND_FIRST,
  KIND_SECOND
};

struct Data
{
  double x;

  EIGEN_MAKE_ALIGNED_OPERATOR_NEW
};

class Sender : public rclcpp::Node
{
public:
  Sender();

  PCL_MAKE_ALIGNED_OPERATOR_NEW  // for its member

private:
  Data data_;
#ifdef WITH_POINTS
  MAP_OF_POINTS
#endif
  PCL_ADD_POINT4D
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr first_, second_;
};
