#include <ros/ros.h>
#include <string>

int main(int argc, char** argv)
{
  ros::init(argc, argv, "detector");
  ros::NodeHandle nh("~");
  std::string model;
  nh.param<std::string>("model", model, "large");
  ros::spin();
}
