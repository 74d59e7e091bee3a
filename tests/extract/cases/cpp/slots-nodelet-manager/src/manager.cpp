#include <nodelet/loader.h>
#include <ros/ros.h>

int main(int argc, char** argv)
{
  ros::init(argc, argv, "manager");
  nodelet::Loader manager;
  ros::spin();
}
