#include <nodelet/loader.h>
#include <ros/ros.h>

int main(int argc, char** argv)
{
  ros::init(argc, argv, "throttle");
  nodelet::Loader loader(false);
  nodelet::M_string remappings(ros::names::getRemappings());
  nodelet::V_string arguments;
  loader.load(ros::this_node::getName(), "nodelets/throttle", remappings, arguments);
  ros::spin();
}
