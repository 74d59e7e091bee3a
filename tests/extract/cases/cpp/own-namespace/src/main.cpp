#include <ros/ros.h>
#include <sensor_msgs/Image.h>
#include <std_msgs/String.h>
#include <string>

int main(int argc, char** argv)
{
  ros::init(argc, argv, "names");
  ros::NodeHandle nh;
  ros::NodeHandle own("~");
  ros::NodeHandle camera("camera");
  std::string space = ros::this_node::getNamespace();
  if (space.substr(0, 2) == "//")
  {
    space.erase(space.begin());
  }
  std::string source;
  own.param<std::string>("source", source, "/objects");
  ros::Subscriber objects = own.subscribe<std_msgs::String>(space + source, 1, [](const std_msgs::String::ConstPtr&) {});
  ros::Publisher markers = own.advertise<std_msgs::String>(space + "/markers", 1);
  ros::Publisher state = nh.advertise<std_msgs::String>(ros::this_node::getName() + "/state", 1);
  ros::Publisher image = own.advertise<sensor_msgs::Image>(camera.getNamespace() + "/image", 1);
  ros::NodeHandle there(nh.getNamespace());
  ros::Publisher plain = there.advertise<std_msgs::String>("plain", 1);
  ros::spin();
  return 0;
}
