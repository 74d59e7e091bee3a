#include <ros/ros.h>
#include <std_msgs/String.h>

class Talker
{
public:
  Talker();

private:
  ros::NodeHandle nh_;
  ros::Publisher state_;
};

class Listener
{
public:
  explicit Listener(const ros::NodeHandle & nh = {}, const ros::NodeHandle & own = {"~"});

private:
  void onLog(const std_msgs::String & message);

  ros::NodeHandle nh_;
  ros::NodeHandle own_;
  ros::Subscriber log_;
  ros::Publisher count_;
};
