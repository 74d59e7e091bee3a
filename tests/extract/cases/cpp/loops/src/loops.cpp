#include <ros/ros.h>
#include <map>
#include <std_msgs/Bool.h>
#include <std_msgs/Float32.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>
#include <std_msgs/Int64.h>
#include <std_msgs/String.h>

static const char* kArray[] = { "x", "y" };

int main(int argc, char** argv)
{
  ros::init(argc, argv, "loops");
  ros::NodeHandle nh;
  std::vector<ros::Publisher> all;
  for (const auto& name : std::vector<std::string>{ "a", "b" })
  {
    all.push_back(nh.advertise<std_msgs::String>("listed/" + name, 1));
  }
  for (size_t i = 0; i < 2; ++i)
  {
    all.push_back(nh.advertise<std_msgs::Int32>(std::string("array/") + kArray[i], 1));
  }
  std::vector<std::string> pushed;
  pushed.push_back("one");
  pushed.emplace_back("two");
  for (std::string name : pushed)
  {
    all.push_back(nh.advertise<std_msgs::Bool>("pushed/" + name, 1));
  }
  for (int i = 0; i < 3; i++)
  {
    all.push_back(nh.advertise<std_msgs::Int64>("counted" + std::to_string(i), 1));
  }
  std::map<std::string, std::string> mapped = { { "key", "value" }, { "other", "value" } };
  for (const auto& [key, value] : mapped)
  {
    all.push_back(nh.advertise<std_msgs::Float32>("mapped/" + key, 1));
  }
  for (int i = 0; i < argc; ++i)
  {
    all.push_back(nh.advertise<std_msgs::Float64>("unbounded" + std::to_string(i), 1));
  }
  ros::spin();
}
