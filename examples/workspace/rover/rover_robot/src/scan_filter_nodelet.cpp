// Removes the robot's own arm from the laser scan, inside a nodelet manager so that no scan is copied.

#include <string>

#include <boost/bind.hpp>
#include <laser_geometry/laser_geometry.h>
#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_srvs/SetBool.h>

namespace rover_robot
{

class ScanFilter : public nodelet::Nodelet
{
private:
  void onInit() override
  {
    ros::NodeHandle& nh = getNodeHandle();
    ros::NodeHandle& private_nh = getPrivateNodeHandle();

    // The parameter names the topic; its default counts while nobody sets it.
    std::string scan_topic;
    private_nh.param<std::string>("scan_topic", scan_topic, "scan");
    private_nh.param("min_range", min_range_, 0.35);
    scan_sub_ = nh.subscribe(scan_topic, 10, &ScanFilter::onScan, this);
    filtered_pub_ = nh.advertise<sensor_msgs::LaserScan>("scan_filtered", 10);

    const ros::SubscriberStatusCallback changed = boost::bind(&ScanFilter::onConnection, this, _1);
    auto options = ros::AdvertiseOptions::create<sensor_msgs::PointCloud2>("scan_cloud", 1, changed, changed, {}, nullptr);
    cloud_pub_ = nh.advertise(options);

    enable_srv_ = getMTPrivateNodeHandle().advertiseService("enable", &ScanFilter::onEnable, this);
  }

  void onConnection(const ros::SingleSubscriberPublisher&)
  {
    cloud_wanted_ = cloud_pub_.getNumSubscribers() > 0;
  }

  void onScan(const sensor_msgs::LaserScan::ConstPtr& scan)
  {
    sensor_msgs::LaserScan filtered = *scan;
    filtered.range_min = min_range_;
    filtered_pub_.publish(filtered);
    if (!cloud_wanted_)
      return;
    sensor_msgs::PointCloud2 cloud;
    projector_.projectLaser(filtered, cloud);
    cloud_pub_.publish(cloud);
  }

  bool onEnable(std_srvs::SetBool::Request& req, std_srvs::SetBool::Response& res)
  {
    min_range_ = req.data ? 0.35 : 0.0;
    res.success = true;
    return true;
  }

  double min_range_ = 0.35;
  bool cloud_wanted_ = false;
  laser_geometry::LaserProjection projector_;
  ros::Publisher filtered_pub_, cloud_pub_;
  ros::Subscriber scan_sub_;
  ros::ServiceServer enable_srv_;
};

}  // namespace rover_robot

PLUGINLIB_EXPORT_CLASS(rover_robot::ScanFilter, nodelet::Nodelet)
