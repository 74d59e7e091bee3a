#include <ros/ros.h>
#include <std_msgs/Bool.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "choir");
  ros::NodeHandle node("~");
  int voices;
  node.getParam("voices", voices);
  ros::Publisher outputs[8];
  switch (voices) {
    case 3:
      outputs[0] = node.advertise<std_msgs::Bool>("alto", 1);
    case 2:
      outputs[1] = node.advertise<std_msgs::Bool>("tenor", 1);
    default:
      outputs[2] = node.advertise<std_msgs::Bool>("bass", 1);
  }
  ros::spin();
}
