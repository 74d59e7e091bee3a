#include <ros/ros.h>
#include <sensor_msgs/Image.h>
#include <toolkit/camera_loader.h>

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "camera");
  ros::NodeHandle nh;
  toolkit::Camera * camera = nullptr;
  if (!toolkit::camera_loader::loadFromRosNs("camera", camera)) {
    return 1;
  }
  ros::Subscriber images = nh.subscribe<sensor_msgs::Image>("image", 1, [](const sensor_msgs::ImageConstPtr &) {});
  ros::Time start = toolkit::getRosTime(3);
  KDL::Tree tree;
  kdl_parser::treeFromParam("robot_description", tree);
  ros::spin();
  return 0;
}
