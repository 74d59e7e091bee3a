#include <ros/ros.h>
#include <std_msgs/String.h>

#define DEFAULT_SPEED 2.0  // m/s
#define DEFAULT_RATIO ((double)(4.25))   // of the first version
#define DEFAULT_COUNT 3 /* wheels */
#define CONTROL_TOPIC "system_control"  // "stop" or "go"
#define DOC_URL "http://example.org/doc"

int main(int argc, char** argv) {
  ros::init(argc, argv, "driver");
  ros::NodeHandle nh("~");
  double speed, ratio;
  int count;
  std::string url;
  nh.param("speed", speed, DEFAULT_SPEED);
  nh.param("ratio", ratio, DEFAULT_RATIO);
  nh.param("count", count, DEFAULT_COUNT);
  nh.param("url", url, std::string(DOC_URL));
  ros::Subscriber control = nh.subscribe<std_msgs::String>(CONTROL_TOPIC, 1, [](const std_msgs::StringConstPtr&) {});
  ros::spin();
}
