#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.h>
#include <std_msgs/String.h>

namespace copies
{
class Marker : public nodelet::Nodelet
{
  virtual void onInit() { publisher_ = getPrivateNodeHandle().advertise<std_msgs::String>("marked", 1); }
  ros::Publisher publisher_;
};
}  // namespace copies
PLUGINLIB_EXPORT_CLASS(copies::Marker, nodelet::Nodelet)
