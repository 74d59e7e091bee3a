#ifndef EITHER_ROS2_TALKER_H
#define EITHER_ROS2_TALKER_H

#ifndef ROS_AVAILABLE
#define ROS_AVAILABLE 1
#endif

#if ROS_AVAILABLE == 1
#include <ros/ros.h>
#define messages std_msgs
#elif ROS_AVAILABLE == 2
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>
#define messages std_msgs::msg
#endif

class Talker {
public:
#if ROS_AVAILABLE == 1
  explicit Talker(ros::NodeHandle &node) { sender = node.advertise<std_msgs::String>("old", 1); }
  ros::Publisher sender;
#elif ROS_AVAILABLE == 2
  explicit Talker(rclcpp::Node &node) { sender = node.create_publisher<messages::String>("new", 1); }
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr sender;
#endif
};

#endif
