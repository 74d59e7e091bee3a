#include <nav_msgs/Odometry.h>
#include <std_msgs/String.h>
#include <toolkit/machine.hpp>

class Robot : public toolkit::Machine<std_msgs::String>, public toolkit::Stoppable
{
public:
  Robot() : toolkit::Machine<std_msgs::String>("state"), odometry_("odom")
  {
    read("speed");
  }

private:
  void read(const std::string& name)
  {
    ros::NodeHandle("~").getParam(name, speed_);
  }

  double speed_;
  toolkit::Machine<nav_msgs::Odometry> odometry_;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "robot");
  Robot robot;
  ros::spin();
}
