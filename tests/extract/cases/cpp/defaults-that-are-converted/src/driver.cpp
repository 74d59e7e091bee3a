#include <ros/ros.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "driver");
  ros::NodeHandle nh("~");
  bool active, silent, monitored;
  double noise, rate{};
  int count;
  nh.param<bool>("active", active, 1);
  nh.param<bool>("silent", silent, 0);
  nh.param<bool>("monitored", monitored, "false");  // the address of a text is true
  nh.param("noise", noise, double());
  nh.param("rate", rate, rate);
  nh.param("count", count, int());
  ros::spin();
}
