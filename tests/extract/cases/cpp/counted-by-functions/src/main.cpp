#include <ros/ros.h>
#include <sstream>

class Poses
{
public:
  void next()
  {
    std::stringstream text;
    text << count_;
    double pose;
    if (!nh_.getParam("pose" + text.str(), pose)) {
      ros::shutdown();
      return;
    }
    count_++;
  }

  ros::NodeHandle nh_{"~"};

private:
  unsigned count_ = 1;
};

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "poses");
  Poses poses;
  while (ros::ok()) {
    poses.next();
    ros::spinOnce();
  }
  return 0;
}
