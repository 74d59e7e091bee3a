#pragma once
#include <ros/ros.h>
#include <std_msgs/String.h>
#include <std_srvs/Empty.h>

ros::Publisher common(ros::NodeHandle& nh);
void unused(ros::NodeHandle& nh);

class First
{
public:
  First();
  ros::NodeHandle nh_;
  ros::Publisher publisher_;
};

class Second
{
public:
  void begin();
  void never();
  bool serve(std_srvs::Empty::Request& request, std_srvs::Empty::Response& response);
  ros::NodeHandle nh_;
  ros::ServiceServer server_;
};
