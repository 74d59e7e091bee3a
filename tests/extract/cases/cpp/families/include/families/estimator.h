#pragma once
#include <ros/ros.h>
#include <message_filters/subscriber.h>
#include <geometry_msgs/PoseStamped.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/Imu.h>
#include <boost/shared_ptr.hpp>
#include <sstream>
#include <string>
#include <vector>

typedef boost::shared_ptr<message_filters::Subscriber<geometry_msgs::PoseStamped>> PoseSubscriber;

template <class Filter>
class Estimator
{
public:
  Estimator() : own_("~") {}

  void run()
  {
    listen();
    state_ = nh_.advertise<nav_msgs::Odometry>("state", 1);
  }

private:
  void listen()
  {
    size_t index = 0;
    bool more = false;
    do
    {
      std::stringstream text;
      text << "imu" << index++;
      std::string name = text.str();
      more = own_.hasParam(name);
      if (more)
      {
        std::string topic;
        own_.getParam(name, topic);
        subscribers_.push_back(nh_.subscribe<sensor_msgs::Imu>(topic, 1, &Estimator<Filter>::imu, this));
      }
    } while (more);
    for (index = 0; own_.hasParam("pose" + std::to_string(index)); ++index)
    {
      std::string topic;
      own_.getParam("pose" + std::to_string(index), topic);
      PoseSubscriber pose(new message_filters::Subscriber<geometry_msgs::PoseStamped>());
      pose->subscribe(nh_, topic, 1);
    }
  }

  void imu(const sensor_msgs::Imu::ConstPtr&) {}

  ros::NodeHandle nh_;
  ros::NodeHandle own_;
  ros::Publisher state_;
  std::vector<ros::Subscriber> subscribers_;
  Filter filter_;
};
