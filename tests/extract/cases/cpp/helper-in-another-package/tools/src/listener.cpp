#include <tools/listener.h>

namespace tools
{
Listener::Listener(std::string topic) { listen(topic); }

void Listener::listen(std::string topic)
{
  if (topic != topic_) {
    topic_ = topic;
    ros::NodeHandle node;
    subscriber_ = node.subscribe<nav_msgs::Odometry>(topic_, 1, boost::bind(&Listener::got, this, _1));
  }
}

void Listener::got(const nav_msgs::Odometry::ConstPtr &) {}
}  // namespace tools
