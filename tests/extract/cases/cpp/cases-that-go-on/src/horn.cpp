#include <ros/ros.h>
#include <std_msgs/Bool.h>

ros::Publisher outputs[8];

void open(ros::NodeHandle& node, int count) {
  switch (count) {
    case 9:
      outputs[0] = node.advertise<std_msgs::Bool>("nine", 1);
      // fall through
    case 2: {
      outputs[1] = node.advertise<std_msgs::Bool>("two", 1);
    }
    case 1:
      outputs[2] = node.advertise<std_msgs::Bool>("one", 1);
      break;
    case 0: {
      outputs[3] = node.advertise<std_msgs::Bool>("none", 1);
      break;
    }
    default:
      outputs[4] = node.advertise<std_msgs::Bool>("other", 1);
  }
  outputs[5] = node.advertise<std_msgs::Bool>("after", 1);
}

int main(int argc, char** argv) {
  ros::init(argc, argv, "horn");
  ros::NodeHandle node;
  open(node, 2);
  ros::spin();
}
