#pragma once
#include <hardware_interface/robot_hw.h>
#include <ros/ros.h>
#include <std_msgs/Int32.h>

namespace demo {

class Hardware : public hardware_interface::RobotHW {
 public:
  virtual bool init(ros::NodeHandle& root_nh, ros::NodeHandle& robot_hw_nh) override;

 private:
  ros::Publisher error_;
};

}  // namespace demo
