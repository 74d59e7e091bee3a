#pragma once
#include <ros/ros.h>
#include <std_msgs/Bool.h>

namespace toolkit
{
template <class State>
class Machine
{
public:
  explicit Machine(const std::string& name) : own_("~")
  {
    publisher_ = own_.advertise<State>(name, 1, true);
  }

private:
  ros::NodeHandle own_;
  ros::Publisher publisher_;
};

class Stoppable
{
public:
  Stoppable();

protected:
  void stop(const std_msgs::BoolConstPtr& stop);
  ros::NodeHandle nh_;
  ros::Subscriber subscriber_;
  double timeout_;
};
}  // namespace toolkit
