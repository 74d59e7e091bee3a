#pragma once
#include <ros/ros.h>
#include <geometry_msgs/Point.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Twist.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/Joy.h>
#include <sensor_msgs/Range.h>

class Base
{
public:
  void inherited(const geometry_msgs::PointConstPtr& point);
};

class Listener : public Base
{
public:
  explicit Listener(ros::NodeHandle& nh);
  void elsewhere(const geometry_msgs::Pose::ConstPtr&);

private:
  void member(const geometry_msgs::TwistConstPtr& twist) {}
  void bound(const sensor_msgs::Imu::ConstPtr& imu, int index) {}
  void second(const std::string& label, const sensor_msgs::Joy::ConstPtr& joy) {}
  template <typename M>
  void any(const boost::shared_ptr<M const>& message)
  {
  }
  std::vector<ros::Subscriber> subscribers_;
  boost::function<void(const sensor_msgs::ImageConstPtr&)> stored_;
};
