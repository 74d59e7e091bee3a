#include <ros/ros.h>
#include <core/serial.h>
#include <sensor_msgs/Imu.h>

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "reader");
  ros::NodeHandle nh;
  core::Serial serial("/dev/ttyUSB0");
  const std::string model = serial.model();
  ros::Publisher data = nh.advertise<sensor_msgs::Imu>("imu/" + model + "/data", 1);
  ros::Publisher raw = nh.advertise<sensor_msgs::Imu>(serial.topic(), 1);
  std::string name = "imu_" + model;
  name += "_filtered";
  ros::Publisher filtered = nh.advertise<sensor_msgs::Imu>(name, 1);
  ros::NodeHandle inner(nh, model);
  ros::Publisher state = inner.advertise<sensor_msgs::Imu>("state", 1);
  ros::spin();
}
