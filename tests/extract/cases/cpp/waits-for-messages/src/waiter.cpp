#include <ros/ros.h>
#include <sensor_msgs/Imu.h>

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "waiter");
  ros::NodeHandle handle("~");
  auto own = ros::topic::waitForMessage<sensor_msgs::Imu>("own", handle, ros::Duration(15));
  auto below = ros::topic::waitForMessage<sensor_msgs::Imu>("below", handle);
  auto global = ros::topic::waitForMessage<sensor_msgs::Imu>("other", ros::Duration(15));
  ros::spin();
}
