#ifndef TOOLS_LISTENER_H
#define TOOLS_LISTENER_H

#include <nav_msgs/Odometry.h>
#include <ros/ros.h>

#include <string>

namespace tools
{
class Listener
{
public:
  explicit Listener(std::string topic = "");
  void listen(std::string topic);

private:
  void got(const nav_msgs::Odometry::ConstPtr & message);
  std::string topic_;
  ros::Subscriber subscriber_;
};
}  // namespace tools

#endif
