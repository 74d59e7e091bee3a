#include <fstream>
#include <string>

#include <ros/ros.h>
#include <std_msgs/String.h>
#include <yaml-cpp/yaml.h>

template <typename T>
void operator>>(const YAML::Node& node, T& value)
{
  value = node.as<T>();
}

int main(int argc, char** argv)
{
  ros::init(argc, argv, "menu");
  ros::NodeHandle nh;
  std::ifstream file("menu.yaml");
  YAML::Node menu = YAML::Load(file);
  double soup, salad, bread, water, juice;
  int tables;
  std::string title;
  menu["soup"] >> soup;
  menu["salad"] >> salad;
  menu["bread"] >> bread;
  menu["water"] >> water;
  menu["juice"] >> juice;
  menu["tables"] >> tables;
  menu["title"] >> title;
  if (title.size() == 0)
  {
    return 1;
  }
  ros::Publisher orders = nh.advertise<std_msgs::String>("orders", 1);
  ros::spin();
  return 0;
}
