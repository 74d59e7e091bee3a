#include <ros/ros.h>
#include <nav_msgs/OccupancyGrid.h>
int main(int argc, char **argv)
{
  ros::init(argc, argv, "map_joiner");
  ros::NodeHandle nh;
  ros::Publisher pub = nh.advertise<nav_msgs::OccupancyGrid>("map", 1);
  ros::spin();
}
