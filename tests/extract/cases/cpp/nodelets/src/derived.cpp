#include "nodelets/base.hpp"
#include <pluginlib/class_list_macros.h>
#include <std_msgs/Bool.h>

namespace nodelets
{
void Base::onInit()
{
  own_ = getPrivateNodeHandle();
  subscriber_ = own_.subscribe("common", 1, &Base::heard, this);
  extend();
}

void Base::heard(const std_msgs::String::ConstPtr& text)
{
}

class Derived : public Base
{
  void extend() override
  {
    publisher_ = own_.advertise<std_msgs::Bool>("derived", 1);
    ros::NodeHandle copied(getPrivateNodeHandle());
    other_ = copied.advertise<std_msgs::Bool>("copied", 1);
  }
  ros::Publisher publisher_, other_;
};
}  // namespace nodelets

PLUGINLIB_EXPORT_CLASS(nodelets::Derived, nodelet::Nodelet)
