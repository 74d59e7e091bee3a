#include "either/talker.h"

#ifndef BUILDING_ROS1
#include <std_msgs/msg/bool.hpp>
#else
#include <std_msgs/Bool.h>
#endif

int main(int argc, char **argv)
{
#if defined ROS_AVAILABLE && ROS_AVAILABLE > 1 // ROS 2
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("either");
  Talker talker(*node);
#else
  ros::init(argc, argv, "either");
  ros::NodeHandle node("~");
  Talker talker(node);
#endif
#ifdef BUILDING_ROS1
  auto flag = node.advertise<std_msgs::Bool>("old_flag", 1);
#else
  auto flag = node->create_publisher<std_msgs::msg::Bool>("new_flag", 1);
#endif
#ifdef WITH_EXTRAS
  auto extra = node->create_publisher<std_msgs::msg::Bool>("extra", 1);
#endif
}
