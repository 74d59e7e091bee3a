#include <controller_interface/controller.h>
#include <geometry_msgs/Twist.h>
#include <hardware_interface/joint_command_interface.h>
#include <nav_msgs/Odometry.h>
#include <pluginlib/class_list_macros.hpp>

namespace handed_down
{
class WheelController : public controller_interface::Controller<hardware_interface::VelocityJointInterface>
{
public:
  bool init(hardware_interface::VelocityJointInterface* hardware, ros::NodeHandle& root, ros::NodeHandle& own) override
  {
    double radius;
    own.getParam("radius", radius);
    std::string robot;
    root.getParam("robot_name", robot);
    publisher_ = own.advertise<nav_msgs::Odometry>("odom", 1);
    subscriber_ = own.subscribe("cmd_vel", 1, &WheelController::command, this);
    return true;
  }

private:
  void command(const geometry_msgs::Twist& command) {}
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
};
}  // namespace handed_down

PLUGINLIB_EXPORT_CLASS(handed_down::WheelController, controller_interface::ControllerBase)
