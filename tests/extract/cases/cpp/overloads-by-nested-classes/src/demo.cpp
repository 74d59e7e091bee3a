#include <ros/ros.h>
#include <outside/odometry.h>

void load(const ros::NodeHandle& nh, Matcher::parameters& params)
{
  nh.getParam("radius", params.radius);
}

void load(const ros::NodeHandle& nh, odometry::Mono::parameters& params)
{
  load(nh, params.matcher);
  nh.getParam("height", params.height);
}

int main(int argc, char** argv)
{
  ros::init(argc, argv, "demo");
  ros::NodeHandle nh("~");
  odometry::Mono::parameters params;
  load(nh, params);
  ros::spin();
}
