#include <controller_interface/controller.h>
#include <hardware_interface/joint_command_interface.h>
#include <pluginlib/class_list_macros.hpp>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

namespace controllers
{
class VelocityController : public controller_interface::Controller<hardware_interface::EffortJointInterface>
{
public:
  bool init(hardware_interface::EffortJointInterface* robot, const std::string& joint, const Pid& pid)
  {
    pid_ = pid;
    return true;
  }

  bool init(hardware_interface::EffortJointInterface* robot, ros::NodeHandle& nh)
  {
    subscriber_ = nh.subscribe("command", 1, &VelocityController::command, this);
    return true;
  }

  void update(const ros::Time& time, const ros::Duration& period)
  {
  }

private:
  void command(const std_msgs::Float64::ConstPtr& message)
  {
  }

  Pid pid_;
  ros::Subscriber subscriber_;
};
}  // namespace controllers

PLUGINLIB_EXPORT_CLASS(controllers::VelocityController, controller_interface::ControllerBase)
