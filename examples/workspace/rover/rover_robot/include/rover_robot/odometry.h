#pragma once

#include <ros/ros.h>
#include <rover_core/WheelSpeeds.h>
#include <tf2_ros/transform_broadcaster.h>

namespace rover_robot
{

/// Integrates wheel speeds into the pose of the rover and tells everybody about it.
class Odometry
{
public:
  explicit Odometry(ros::NodeHandle& nh);

  void update(const rover_core::WheelSpeeds& speeds);

private:
  ros::Publisher odometry_pub_;
  ros::Publisher path_pub_;
  tf2_ros::TransformBroadcaster broadcaster_;
};

}  // namespace rover_robot
