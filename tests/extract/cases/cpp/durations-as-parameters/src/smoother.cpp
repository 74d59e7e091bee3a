#include <chrono>
#include <ros/ros.h>
#include <string>

void read(const ros::NodeHandle& nh, const std::string& name, ros::Duration& duration)
{
  double seconds = duration.toSec();
  nh.param(name, seconds, seconds);
  duration.fromSec(seconds);
}

constexpr const std::chrono::milliseconds kInterval{40};

struct Settings
{
  ros::Duration lag{5.0};
  ros::Duration period{0, 500000000};

  void load(const ros::NodeHandle& nh)
  {
    read(nh, "lag", lag);
    read(nh, "period", period);
    nh.param("timeout", timeout, 2.0 * lag.toSec());
    nh.param<int>("interval", interval, kInterval.count());
  }

  double timeout;
  int interval;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "smoother");
  Settings settings;
  settings.load(ros::NodeHandle("~"));
  ros::spin();
}
