#include <string>
#include <vector>

#include <ros/ros.h>
#include <std_msgs/String.h>

struct Adapter
{
  bool init(std::vector<std::string>& /*names*/, ros::NodeHandle& /*nh*/)
  {
    return true;
  }
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "sender");
  ros::NodeHandle nh;
  std::vector<std::string> names = {"a", "b"};
  Adapter adapter;
  adapter.init(names, nh);
  ros::Publisher publisher = nh.advertise<std_msgs::String>(names[0], 1);
  ros::spin();
}
