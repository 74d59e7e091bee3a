#include "copies.h"

Talker::Talker()
{
  state_ = nh_.advertise<std_msgs::String>("state", 1);
}

Listener::Listener(const ros::NodeHandle & nh, const ros::NodeHandle & own) : nh_{nh}, own_{own, "inner"}
{
  log_ = nh_.subscribe("log", 1, &Listener::onLog, this);
  count_ = own_.advertise<std_msgs::String>("count", 1);
}

void Listener::onLog(const std_msgs::String & message)
{
}

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "copies");
  Talker talker = Talker();
  Listener listener{};
  ros::spin();
}
