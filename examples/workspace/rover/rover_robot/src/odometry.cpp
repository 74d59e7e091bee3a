#include "rover_robot/odometry.h"

#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>

#include "rover_core/topics.h"

namespace rover_robot
{

Odometry::Odometry(ros::NodeHandle& nh)
{
  // The name stands in a header of another package.
  odometry_pub_ = nh.advertise<nav_msgs::Odometry>(rover_core::topics::kOdometry, 10);

  ros::NodeHandle debug(nh, "debug");
  path_pub_ = debug.advertise<nav_msgs::Path>("driven_path", 1, /* latch = */ true);
}

void Odometry::update(const rover_core::WheelSpeeds& speeds)
{
  constexpr double kPeriod = 0.1;
  static double distance = 0.0;
  nav_msgs::Odometry odometry;
  odometry.header = speeds.header;
  odometry.twist.twist.linear.x = (speeds.left + speeds.right) / 2.0;
  odometry.pose.pose.position.x = (distance += odometry.twist.twist.linear.x * kPeriod);
  odometry_pub_.publish(odometry);

  nav_msgs::Path path;
  path.header = speeds.header;
  path_pub_.publish(path);

  geometry_msgs::TransformStamped transform;
  transform.header = speeds.header;
  broadcaster_.sendTransform(transform);
}

}  // namespace rover_robot
