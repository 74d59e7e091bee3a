#include "hardware.h"

namespace demo {

bool Hardware::init(ros::NodeHandle& root_nh, ros::NodeHandle& robot_hw_nh) {
  error_ = robot_hw_nh.advertise<std_msgs::Int32>("error", 1);
  return true;
}

}  // namespace demo

#include <pluginlib/class_list_macros.h>
PLUGINLIB_EXPORT_CLASS(demo::Hardware, hardware_interface::RobotHW)
