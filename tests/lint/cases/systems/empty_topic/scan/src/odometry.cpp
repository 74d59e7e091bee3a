#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>

void onPose(const nav_msgs::Odometry & pose) {}
void onScan(const sensor_msgs::LaserScan & scan) {}

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "odometry");
  ros::NodeHandle nh, own("~");
  std::string pose, frame, scan;
  own.param<std::string>("pose_topic", pose, "/pose");
  own.param<std::string>("robot", frame, "");
  own.param<std::string>("scan_topic", scan, "/scan");
  ros::Subscriber first;
  if (pose != "") {
    first = nh.subscribe(pose, 1, onPose);
  }
  if (frame.empty()) {
    frame = "odom";
  }
  ros::Publisher odometry = nh.advertise<nav_msgs::Odometry>(frame, 1);
  ros::Subscriber second = nh.subscribe(scan, 1, onScan);
  odometry.publish(nav_msgs::Odometry());
  ros::spin();
}
