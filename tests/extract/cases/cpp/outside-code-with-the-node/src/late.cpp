#include <ros/ros.h>
#include <voxel_maps/server.h>

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "late");
  ros::NodeHandle nh;
  voxel_maps::Server server;
  server.start(nh);
  ros::spin();
  return 0;
}
