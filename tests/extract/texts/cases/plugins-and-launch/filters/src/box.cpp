#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.h>
#include <sensor_msgs/PointCloud2.h>
namespace filters
{
// Crops clouds to a box whose corners
// are parameters.
class Box : public nodelet::Nodelet
{
  void onInit() override
  {
    pub_ = getNodeHandle().advertise<sensor_msgs::PointCloud2>("inside", 1);
  }
  ros::Publisher pub_;
};
}
PLUGINLIB_EXPORT_CLASS(filters::Box, nodelet::Nodelet)
