#include <boost/algorithm/string.hpp>
#include <ros/ros.h>
#include <std_msgs/String.h>

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "sender");
  ros::NodeHandle node;
  ros::Publisher lower = node.advertise<std_msgs::String>("finger_" + boost::to_lower_copy(std::string("FFJ0")), 1);
  std::string joint = boost::algorithm::to_upper_copy("arm_" + std::string(argv[1]));
  ros::Publisher upper = node.advertise<std_msgs::String>(joint + "/state", 1);
  ros::spin();
}
