#include <nodelet/loader.h>
#include <ros/ros.h>

void load(nodelet::Loader& loader, const std::string& side)
{
  nodelet::M_string remappings;
  nodelet::V_string arguments;
  remappings["in"] = ros::names::resolve(side + "/in");
  remappings["out"] = ros::names::resolve(side + "/out");
  loader.load(ros::this_node::getName() + "_" + side, "copies/copy", remappings, arguments);
}

int main(int argc, char** argv)
{
  ros::init(argc, argv, "pair");
  nodelet::Loader loader(false);
  load(loader, "left");
  load(loader, "right");
  ros::spin();
}
