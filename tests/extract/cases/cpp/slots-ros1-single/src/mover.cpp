#include <pluginlib/class_loader.hpp>
#include <ros/ros.h>

#include <memory>
#include <string>

namespace nav
{
class LocalPlanner;
class Recovery;
class Logger;
}  // namespace nav

class Mover
{
public:
  Mover() : planners_("nav_core", "nav::LocalPlanner"), loggers_("nav_core", "nav::Logger")
  {
    ros::NodeHandle private_nh("~");
    std::string planner;
    private_nh.param("base_local_planner", planner, std::string("nav/Trajectory"));
    planner_ = planners_.createInstance(planner);
    recoveries_.reset(new pluginlib::ClassLoader<nav::Recovery>("nav_core", "nav::Recovery"));
    first_ = recoveries_->createUniqueInstance("nav/Clear");
    second_ = recoveries_->createUnmanagedInstance("nav/Turn");
  }

private:
  pluginlib::ClassLoader<nav::LocalPlanner> planners_;
  pluginlib::ClassLoader<nav::Logger> loggers_;
  std::unique_ptr<pluginlib::ClassLoader<nav::Recovery>> recoveries_;
  boost::shared_ptr<nav::LocalPlanner> planner_;
  pluginlib::UniquePtr<nav::Recovery> first_;
  nav::Recovery* second_;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "mover");
  Mover mover;
  ros::spin();
}
