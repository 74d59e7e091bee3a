#pragma once
#include <ros/ros.h>

extern std::string scan_topic, imu_topic;
extern bool use_imu;
extern ros::Publisher state;

void readSettings(ros::NodeHandle& nh);
