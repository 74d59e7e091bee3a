#include "parts.hpp"

ros::Publisher common(ros::NodeHandle& nh)
{
  return nh.advertise<std_msgs::String>("common", 1);
}

void unused(ros::NodeHandle& nh)
{
  static ros::Publisher publisher = nh.advertise<std_msgs::String>("unused", 1);
}
