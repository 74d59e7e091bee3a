#pragma once
#include <nodelet/nodelet.h>
#include <std_msgs/String.h>

namespace nodelets
{
class Base : public nodelet::Nodelet
{
protected:
  virtual void onInit();
  virtual void extend() = 0;
  void heard(const std_msgs::String::ConstPtr& text);
  ros::NodeHandle own_;
  ros::Subscriber subscriber_;
};
}  // namespace nodelets
