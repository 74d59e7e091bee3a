#include <ros/ros.h>
#include <std_msgs/String.h>
#include <std_srvs/SetBool.h>

void onLog(const std_msgs::String::ConstPtr & message)
{
}

bool onPower(std_srvs::SetBool::Request & request, std_srvs::SetBool::Response & response)
{
  return true;
}

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "bridge");
  ros::NodeHandle nh;
  ros::Publisher state = nh.advertise<std_msgs::String>("state", 1);
  ros::Subscriber log = nh.subscribe("log", 1, onLog);
  ros::ServiceServer power = nh.advertiseService("power", onPower);
  ros::ServiceClient light = nh.serviceClient<std_srvs::SetBool>("light");
  ros::spin();
}
