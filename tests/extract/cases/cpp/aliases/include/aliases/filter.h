#pragma once
#include <boost/shared_ptr.hpp>
#include <message_filters/subscriber.h>
#include <ros/ros.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/MagneticField.h>

class Filter
{
  typedef sensor_msgs::Imu ImuMsg;
  typedef message_filters::Subscriber<ImuMsg> ImuSubscriber;
  using FieldSubscriber = message_filters::Subscriber<sensor_msgs::MagneticField>;

public:
  explicit Filter(ros::NodeHandle nh);

private:
  ros::NodeHandle nh_;
  boost::shared_ptr<ImuSubscriber> imu_;
  boost::shared_ptr<FieldSubscriber> field_;
};
