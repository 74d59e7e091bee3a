#include <ros/ros.h>
#include <std_msgs/Float64.h>
int main(int argc, char **argv)
{
  ros::init(argc, argv, "arm_driver");
  ros::NodeHandle nh;
  ros::Publisher pub = nh.advertise<std_msgs::Float64>("state", 1);
  ros::spin();
}
