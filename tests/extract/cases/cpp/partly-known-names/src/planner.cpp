#include <ros/ros.h>
#include <pluginlib/class_list_macros.h>
#include <core/base_planner.h>
#include <nav_msgs/Path.h>
#include <std_srvs/Trigger.h>

namespace partly_known
{

class Planner : public core::BasePlanner
{
public:
  void initialize(std::string name) override
  {
    ros::NodeHandle n("~/" + name);
    plan_ = n.advertise<nav_msgs::Path>("plan", 1);
    ros::NodeHandle own("~");
    preview_ = own.advertise<nav_msgs::Path>(name + "/preview", 1);
    ros::NodeHandle other(own, "fixed");
    fixed_ = other.advertise<nav_msgs::Path>("plan", 1);
    n.param("tolerance", tolerance_, 0.5);
  }

private:
  ros::Publisher plan_, preview_, fixed_;
  double tolerance_;
};

}  // namespace partly_known

PLUGINLIB_EXPORT_CLASS(partly_known::Planner, core::BasePlanner)
