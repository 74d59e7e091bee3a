#include <ros/ros.h>
#include <std_msgs/String.h>
#include "lines.h"

void ignore(const std_msgs::String::ConstPtr& message)
{
}

int main(int argc, char** argv)
{
  ros::init(argc, argv, "demo");
  ros::NodeHandle nh;
  ros::Publisher kept = nh.advertise<std_msgs::String>("lines", 5);
  ros::Publisher unused = nh.advertise<std_msgs::String>("unused", 5);
  ros::Subscriber held = nh.subscribe<std_msgs::String>("words", 5, ignore);
  read_lines(nh);
  ros::spin();
}
