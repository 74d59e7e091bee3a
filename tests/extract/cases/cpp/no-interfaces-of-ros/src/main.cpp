#include <ros/ros.h>
#include <std_msgs/String.h>

// nh.advertise<std_msgs::String>("comment", 1);
class Newspaper
{
public:
  template <typename T>
  void advertise(const std::string& text, int price)
  {
  }
  void subscribe(const std::string& reader, int years, const std::string& address)
  {
  }
  void call(const std::string& number)
  {
  }
};

void subscribe(const std::string& reader, int years, const std::string& address)
{
}

int main(int argc, char** argv)
{
  ros::init(argc, argv, "no_interfaces_of_ros");
  ros::NodeHandle nh;
  ros::Publisher publisher = nh.advertise<std_msgs::String>("real", 1);
  Newspaper paper;
  paper.advertise<std_msgs::String>("old car", 100);
  paper.subscribe("reader", 1, "address");
  subscribe("reader", 1, "address");
  paper.call("number");
  ROS_INFO("nh.advertise<std_msgs::String>(\"text\", 1)");
#if 0
  ros::Publisher never = nh.advertise<std_msgs::String>("switched_off", 1);
#endif
}
