#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.h>
#include <std_msgs/String.h>

namespace copies
{
class Copy : public nodelet::Nodelet
{
  virtual void onInit()
  {
    publisher_ = getNodeHandle().advertise<std_msgs::String>("out", 1);
    subscriber_ = getNodeHandle().subscribe("in", 1, &Copy::copy, this);
  }
  void copy(const std_msgs::StringConstPtr& text) {}
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
};
}  // namespace copies
PLUGINLIB_EXPORT_CLASS(copies::Copy, nodelet::Nodelet)
