#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_srvs/Empty.h>

bool decorate(std_srvs::Empty::Request&, std_srvs::Empty::Response&) { return true; }

int main(int argc, char** argv) {
  std::string kind = KIND;
  ros::init(argc, argv, kind);
  ros::NodeHandle node("~");
  ros::Publisher ready = node.advertise<std_msgs::Bool>(STATE "/ready", QUEUE);
  ros::ServiceServer decorating;
  if (kind == "cake") {
    decorating = node.advertiseService("decorate", decorate);
  }
  ros::spin();
}
