#include <string>

#include <pluginlib/class_list_macros.h>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <vendor_control/controller.h>

namespace wheels
{
class Wheel : public vendor_control::Controller
{
public:
  bool init(vendor_control::Robot * robot, const std::string & joint, double gain)
  {
    robot_ = robot;
    joint_ = joint;
    gain_ = gain;
    return true;
  }

  bool init(vendor_control::Robot * robot, ros::NodeHandle & handle)
  {
    handle.param("gain", gain_, 1.0);
    command_ = handle.subscribe<std_msgs::Float64>("command", 1, &Wheel::onCommand, this);
    return init(robot, "wheel", gain_);
  }

private:
  void onCommand(const std_msgs::Float64::ConstPtr & command) {target_ = command->data;}

  vendor_control::Robot * robot_;
  std::string joint_;
  double gain_, target_;
  ros::Subscriber command_;
};
}  // namespace wheels

PLUGINLIB_EXPORT_CLASS(wheels::Wheel, vendor_control::Controller)
