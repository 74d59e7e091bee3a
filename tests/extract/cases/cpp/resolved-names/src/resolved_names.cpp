#include <image_transport/image_transport.h>
#include <image_transport/subscriber_filter.h>
#include <ros/ros.h>
#include <std_msgs/Bool.h>

int main(int argc, char** argv)
{
  ros::init(argc, argv, "resolver");
  ros::NodeHandle nh;
  ros::NodeHandle own("~");
  ros::NodeHandle color(nh, "head/color"), depth(own, "depth");

  image_transport::ImageTransport transport(color);
  image_transport::SubscriberFilter image;
  image.subscribe(transport, color.resolveName("image_raw"), 1);
  ros::Publisher a = own.advertise<std_msgs::Bool>(nh.resolveName("shared"), 1);
  ros::Publisher b = color.advertise<std_msgs::Bool>(depth.resolveName("ready"), 1);
  ros::Publisher c = own.advertise<std_msgs::Bool>(ros::names::resolve("plain"), 1);
  ros::spin();
}
