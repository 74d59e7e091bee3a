#include <ros/ros.h>
#include <std_msgs/String.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "driver");
  ros::NodeHandle nh("~");
  double value, limit = 5.0;
  nh.param("first", value, 2.0);
  double first = value;
  nh.getParam("second", value);  // holds the first if it is not set, which is no default
  nh.getParam("limit", limit);
  std::string topic;
  nh.param("old_topic", topic, std::string("status"));
  nh.getParam("topic", topic);
  ros::Publisher status = nh.advertise<std_msgs::String>(topic, 1);
  ros::spin();
}
