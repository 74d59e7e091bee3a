#include <geometry_msgs/Pose.h>
#include <ros/ros.h>
#include <sensor_msgs/NavSatFix.h>
#include <std_msgs/Empty.h>

#ifdef POSE
struct Pose {
  explicit Pose(ros::NodeHandle& nh) : publisher(nh.advertise<geometry_msgs::Pose>("pose", 1)) {}
  ros::Publisher publisher;
};
#endif

int main(int argc, char** argv) {
  ros::init(argc, argv, "driver");
  ros::NodeHandle nh;
  ros::Publisher ready = nh.advertise<std_msgs::Empty>("ready", 1);
#ifdef POSE
  Pose pose(nh);
#endif
#if defined(GPS)
  ros::Publisher fix = nh.advertise<sensor_msgs::NavSatFix>("fix", 1);
#endif
  ros::spin();
}
