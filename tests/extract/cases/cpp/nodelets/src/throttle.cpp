#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Float64.h>

namespace nodelets
{
class Throttle : public nodelet::Nodelet
{
  void onInit() override
  {
    ros::NodeHandle& nh = getMTNodeHandle();
    ros::NodeHandle& own = this->getMTPrivateNodeHandle();
    double rate = own.param("rate", 1.5);
    publisher_ = nh.advertise<sensor_msgs::PointCloud2>("out", 1);
    rate_ = own.advertise<std_msgs::Float64>("rate", 1, true);
    subscriber_ = nh.subscribe("in", 1, &Throttle::pass, this);
  }
  void pass(const sensor_msgs::PointCloud2::ConstPtr& cloud)
  {
    publisher_.publish(cloud);
  }
  ros::Publisher publisher_, rate_;
  ros::Subscriber subscriber_;
};
}  // namespace nodelets

PLUGINLIB_EXPORT_CLASS(nodelets::Throttle, nodelet::Nodelet)
