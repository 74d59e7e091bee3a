#include "settings.h"
#include <ros/ros.h>
#include <sensor_msgs/Imu.h>
#include <std_msgs/Empty.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "driver");
  ros::NodeHandle nh("~");
  int size;
  double hit;
#ifdef HASHED
  nh.param("reserved", size, 1000);
#else
  nh.param("width", size, 10);
#endif
#ifdef PROBABILISTIC
  nh.param("hit", hit, 0.7);
#endif
#ifdef WITH_IMU
  ros::Publisher imu = nh.advertise<sensor_msgs::Imu>("imu", 1);
#endif
#ifdef SIZE
  ros::Publisher full = nh.advertise<std_msgs::Empty>("full", 1);
#endif
  ros::spin();
}
