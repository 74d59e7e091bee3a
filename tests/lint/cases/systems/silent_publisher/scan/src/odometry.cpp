#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <ros/ros.h>

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "odometry");
  ros::NodeHandle nh;
  ros::Publisher odometry = nh.advertise<nav_msgs::Odometry>("odom", 1);
  ros::Publisher driven = nh.advertise<nav_msgs::Path>("driven", 1);
  while (ros::ok()) {
    odometry.publish(nav_msgs::Odometry());
  }
}
