#ifdef WITH_OLD
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#elif WITH_NEW
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>
#endif

int main(int argc, char ** argv)
{
#ifdef WITH_OLD
  ros::init(argc, argv, "either");
  ros::NodeHandle node;
  auto flag = node.advertise<std_msgs::Bool>("old_flag", 1);
#elif WITH_NEW
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("either");
  auto flag = node->create_publisher<std_msgs::msg::Bool>("new_flag", 1);
#endif
}
