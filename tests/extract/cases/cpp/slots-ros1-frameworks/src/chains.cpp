#include <controller_manager/controller_manager.h>
#include <filters/filter_chain.h>
#include <hardware_interface/robot_hw.h>
#include <nodelet/loader.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>

int main(int argc, char** argv)
{
  ros::init(argc, argv, "chains");
  ros::NodeHandle nh;
  ros::NodeHandle pnh("~");
  filters::FilterChain<sensor_msgs::LaserScan> scans("sensor_msgs::LaserScan");
  scans.configure("scan_filter_chain", pnh);
  filters::MultiChannelFilterChain<double> channels("double");
  channels.configure(3, "wheels", nh);
  nodelet::Loader manager;
  nodelet::M_string remappings;
  nodelet::V_string arguments;
  nodelet::Loader inner(false);
  inner.load("watch", "chains/Watch", remappings, arguments);
  hardware_interface::RobotHW robot;
  controller_manager::ControllerManager controllers(&robot, nh);
  ros::spin();
}
