#include <ros/ros.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "laser");
  ros::NodeHandle node;
  auto scans = node.advertise<sensor_msgs::LaserScan>("scan_raw", 1);
}
