#pragma once

namespace senders
{
template <class Part>
bool Sender<Part>::init(ros::NodeHandle& nh)
{
  subscriber_ = nh.subscribe("command", 1, &Sender::command, this);
  publisher_.reset(new StatePublisher(nh, "state", 1));
  server_.reset(new ActionServer(nh, "follow", false));
  return true;
}

template <class Part>
void Sender<Part>::command(const JointTrajectoryConstPtr& message)
{
}
}  // namespace senders
