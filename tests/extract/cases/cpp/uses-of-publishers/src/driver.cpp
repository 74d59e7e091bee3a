#include "uses_of_publishers/driver.h"

// unused_.publish(text) would publish, but this is a comment.
Driver::Driver(ros::NodeHandle& nh) : counted_(nh.advertise<std_msgs::String>("counted", 1))
{
  unused_ = nh.advertise<std_msgs::String>("unused", 1);
  answer_ = nh.advertise<std_msgs::String>("answer", 1);
  always_ = nh.advertise<std_msgs::String>("always", 1);
  passed_ = nh.advertise<std_msgs::String>("passed", 1);
  odometry_ = nh.advertise<nav_msgs::Odometry>("odom", 1);
  imu_ = nh.advertise<sensor_msgs::Imu>("imu", 1);
  firmware_ = nh.subscribe("firmware", 1, &Driver::firmware, this);
  printed_ = nh.subscribe("printed", 1, &Driver::printed, this);
  unread_ = nh.subscribe<std_msgs::String>("unread", 1, [](const std_msgs::String::ConstPtr&) { ROS_INFO("unread"); });
  measured_.orientation_covariance[0] = -1;
  watch(passed_);
}

void Driver::firmware(const std_msgs::String::ConstPtr& text)
{
  reply(text->data);
}

void Driver::printed(const std_msgs::String::ConstPtr& text)
{
  // nothing yet
  ROS_INFO_STREAM("heard " << text->data);
  return;
}

void Driver::reply(const std::string& text)
{
  std_msgs::String message;
  message.data = text;
  answer_.publish(message);
  always_.publish(message);
}

void Driver::update()
{
  if (counted_.getNumSubscribers() == 0)
    return;
  always_.publish(std_msgs::String());
  nav_msgs::Odometry odometry;
  odometry.pose.pose.position.x = 1.5;
  odometry.twist.twist.linear.x = 0.0;
  odometry_.publish(odometry);
  measured_.orientation.w = 1;
  measured_.angular_velocity.z = 0.5;
  imu_.publish(measured_);
}
