#include <ros/ros.h>
#include <std_msgs/Int32.h>
#include <cstdlib>
#include <string>

class Reader
{
public:
  explicit Reader(ros::NodeHandle& nh)
  {
    nh.param<std::string>("camera", camera_, "");
    if (!camera_.empty())
    {
      pub_ = nh.advertise<std_msgs::Int32>("/" + camera_ + "/state", 1);
    }
    else
    {
      pub_ = nh.advertise<std_msgs::Int32>("/state" + camera_, 1);
    }
  }

private:
  std::string camera_;
  ros::Publisher pub_;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "demo");
  ros::NodeHandle nh("~");
  std::string robot, arm, base;
  nh.param<std::string>("robot", robot, "");
  if (robot.empty())
    return 1;
  ros::Publisher one = nh.advertise<std_msgs::Int32>("/" + robot + "/mode", 1);
  nh.param<std::string>("arm", arm, "");
  if (arm == "" || arm.size() < 1)
  {
    exit(1);
  }
  ros::Publisher two = nh.advertise<std_msgs::Int32>("/" + arm + "/mode", 1);
  nh.param<std::string>("base", base, "");
  if (base.length() == 0)
    throw std::runtime_error("no base");
  ros::Publisher three = nh.advertise<std_msgs::Int32>("/" + base + "/mode", 1);
  Reader reader(nh);
  ros::spin();
}
