#include "my_camera/camera.h"

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "sender");
  ros::NodeHandle handle;
  my_camera::Camera camera(handle);
  ros::spin();
}
