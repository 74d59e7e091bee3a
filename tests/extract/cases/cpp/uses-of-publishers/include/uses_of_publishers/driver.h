#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/Imu.h>
#include <std_msgs/String.h>

class Driver
{
public:
  explicit Driver(ros::NodeHandle& nh);
  void update();

private:
  void printed(const std_msgs::String::ConstPtr& text);
  void firmware(const std_msgs::String::ConstPtr& text);
  void reply(const std::string& text);
  void watch(ros::Publisher& passed);

  ros::Publisher unused_, counted_, answer_, always_, passed_, odometry_, imu_;
  ros::Subscriber firmware_, unread_, printed_;
  sensor_msgs::Imu measured_;
};
