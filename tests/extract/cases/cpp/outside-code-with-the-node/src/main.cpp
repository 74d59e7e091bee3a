#include <ros/ros.h>
#include <tf/transform_listener.h>
#include <voxel_maps/server.h>

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "mapper");
  ros::NodeHandle nh, private_nh("~");
  tf::TransformListener listener(nh);
  voxel_maps::Server server(nh, private_nh);
  double range;
  private_nh.getParam("range", range);
  ros::spin();
  return 0;
}
