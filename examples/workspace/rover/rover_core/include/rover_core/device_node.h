#pragma once

#include <string>

#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/String.h>
#include <std_srvs/Trigger.h>

#include "rover_core/topics.h"

namespace rover_core
{

/// What every device of the rover has in common: it tells its status, obeys the emergency stop and can test itself.
class DeviceNode
{
public:
  explicit DeviceNode(const std::string& device) : private_nh_("~"), device_(device)
  {
    status_pub_ = nh_.advertise<std_msgs::String>(device_ + "/status", 1, true);
    stop_sub_ = nh_.subscribe(ROVER_STOP_TOPIC, 1, &DeviceNode::onStop, this);
    self_test_srv_ = private_nh_.advertiseService("self_test", &DeviceNode::onSelfTest, this);
  }

  virtual ~DeviceNode() = default;

protected:
  virtual bool selfTest() = 0;
  virtual void stop() = 0;

  ros::NodeHandle nh_;
  ros::NodeHandle private_nh_;

private:
  void onStop(const std_msgs::Bool::ConstPtr& msg)
  {
    if (msg->data)
      stop();
  }

  bool onSelfTest(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& res)
  {
    res.success = selfTest();
    return true;
  }

  std::string device_;
  ros::Publisher status_pub_;
  ros::Subscriber stop_sub_;
  ros::ServiceServer self_test_srv_;
};

}  // namespace rover_core
