#include <ros/ros.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "quiet");
  ros::NodeHandle handle;
  ros::spin();
}
