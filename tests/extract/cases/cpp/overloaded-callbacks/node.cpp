#include <ros/ros.h>
#include <std_msgs/String.h>
#include <std_srvs/Empty.h>

void update(const std_msgs::String::ConstPtr& message) {}

bool update(std_srvs::Empty::Request& request, std_srvs::Empty::Response& response)
{
  return true;
}

bool change(std_srvs::Empty::Request& request, std_srvs::Empty::Response& response)
{
  return true;
}

void change(const std_msgs::String::ConstPtr& message) {}

int main(int argc, char** argv)
{
  ros::init(argc, argv, "server");
  ros::NodeHandle node;
  ros::ServiceServer service = node.advertiseService("update", update);
  ros::Subscriber subscriber = node.subscribe("updates", 1, change);
  ros::spin();
}
