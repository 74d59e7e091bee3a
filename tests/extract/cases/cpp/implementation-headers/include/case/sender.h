#pragma once
#include <memory>

#include <actionlib/server/action_server.h>
#include <control_msgs/FollowJointTrajectoryAction.h>
#include <realtime_tools/realtime_publisher.h>
#include <ros/ros.h>
#include <std_msgs/Int32.h>
#include <trajectory_msgs/JointTrajectory.h>

namespace senders
{
template <class Part>
class Sender
{
public:
  bool init(ros::NodeHandle& nh);

private:
  typedef actionlib::ActionServer<control_msgs::FollowJointTrajectoryAction> ActionServer;
  typedef realtime_tools::RealtimePublisher<std_msgs::Int32> StatePublisher;
  typedef trajectory_msgs::JointTrajectory::ConstPtr JointTrajectoryConstPtr;

  void command(const JointTrajectoryConstPtr& message);

  Part part_;
  ros::Subscriber subscriber_;
  std::shared_ptr<ActionServer> server_;
  std::unique_ptr<StatePublisher> publisher_;
};
}  // namespace senders

#include "case/sender_impl.h"
