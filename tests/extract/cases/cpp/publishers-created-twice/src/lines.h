#include <ros/ros.h>
#include <std_msgs/String.h>

inline void store(const std_msgs::String::ConstPtr& message)
{
  ROS_INFO("%s", message->data.c_str());
}

inline void read_lines(ros::NodeHandle& nh)
{
  ros::Publisher lines = nh.advertise<std_msgs::String>("lines", 5);
  ros::Subscriber words = nh.subscribe<std_msgs::String>("words", 5, store);
  std_msgs::String line;
  line.data = "line";
  lines.publish(line);
}
