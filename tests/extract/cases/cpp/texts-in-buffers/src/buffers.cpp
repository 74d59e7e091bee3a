#include <cstdio>
#include <cstring>
#include <ros/ros.h>
#include <std_msgs/String.h>
#include <vector>

int main(int argc, char** argv)
{
  ros::init(argc, argv, "buffers");
  ros::NodeHandle nh;
  std::vector<ros::Publisher> all;
  char name[64];
  sprintf(name, "joint_%d/state", 1);
  all.push_back(nh.advertise<std_msgs::String>(name, 1));
  for (int index = 0; index < 2; index++)
  {
    char each[64];
    std::snprintf(each, sizeof(each), "arm_%d/%s", index, "cmd");
    all.push_back(nh.advertise<std_msgs::String>(std::string(each), 1));
  }
  strcpy(name, "base");
  strcat(name, "/scan");
  all.push_back(nh.advertise<std_msgs::String>(name, 1));
  std::string topic = "image";
  topic.insert(0, "left/");
  topic.push_back('s');
  all.push_back(nh.advertise<std_msgs::String>(topic, 1));
  topic.insert(4, "_eye");
  all.push_back(nh.advertise<std_msgs::String>(topic, 1));
  ros::spin();
}
