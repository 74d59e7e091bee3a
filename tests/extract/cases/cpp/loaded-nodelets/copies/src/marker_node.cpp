#include <nodelet/loader.h>
#include <ros/ros.h>

// The name of the nodelet is without that of its package.
int main(int argc, char ** argv)
{
  ros::init(argc, argv, "marker");
  nodelet::Loader loader(false);
  nodelet::M_string remappings(ros::names::getRemappings());
  nodelet::V_string arguments;
  loader.load(ros::this_node::getName(), "Marker", remappings, arguments);
  ros::spin();
}
