#include <ros/ros.h>
#include <std_msgs/String.h>
#include <std_srvs/Empty.h>
#include <cstring>
int main(int argc, char** argv) {
  ros::init(argc, argv, "tool");
  ros::NodeHandle nh;
  ros::Publisher done = nh.advertise<std_msgs::String>("done", 1);
  if ((argc == 3 || argc == 4) && std::string(argv[1]) == "add") {
    ros::Publisher added = nh.advertise<std_msgs::String>("added", 1);
  } else if (argc == 3 && strcmp(argv[1], "replace") == 0) {
    std::string name(argv[2]);
    std_srvs::Empty srv;
    ros::service::call(name + "/replace", srv);
  } else {
    ros::Publisher help = nh.advertise<std_msgs::String>("help", 1);
  }
}
