#include "settings.h"
#include <std_msgs/String.h>

std::string scan_topic, imu_topic;
bool use_imu = true;
ros::Publisher state;

void readSettings(ros::NodeHandle& nh) {
  nh.param<std::string>("scan_topic", scan_topic, "/scan");
  nh.param<std::string>("imu_topic", imu_topic, "/imu");
  nh.param<bool>("use_imu", use_imu, 1);
  state = nh.advertise<std_msgs::String>("state", 1);
}
