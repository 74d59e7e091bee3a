// Turns velocity commands into wheel commands, and wheel speeds into odometry.

#include <memory>

#include <boost/bind.hpp>
#include <diagnostic_updater/diagnostic_updater.h>
#include <dynamic_reconfigure/server.h>
#include <geometry_msgs/Twist.h>
#include <realtime_tools/realtime_publisher.h>
#include <ros/ros.h>
#include <sensor_msgs/BatteryState.h>
#include <std_msgs/Float64.h>
#include <std_srvs/Empty.h>
#include <std_srvs/SetBool.h>

#include <rover_core/WheelSpeeds.h>
#include <rover_core/device_node.h>
#include <rover_core/topics.h>

#include "rover_robot/DriveConfig.h"
#include "rover_robot/odometry.h"

namespace rover_robot
{

class BaseController : public rover_core::DeviceNode
{
public:
  BaseController() : DeviceNode("base"), odometry_(nh_), reconfigure_(private_nh_)
  {
    private_nh_.param("wheel_radius", wheel_radius_, 0.1);
    if (!private_nh_.getParam("wheel_separation", wheel_separation_))
      ROS_FATAL("The parameter ~wheel_separation is missing");

    // A member function takes the message.
    command_sub_ = nh_.subscribe("cmd_vel", 1, &BaseController::onCommand, this);

    // A bound function: the type stands in the template argument.
    speeds_sub_ = nh_.subscribe<rover_core::WheelSpeeds>("wheel_speeds", 10, boost::bind(&BaseController::onSpeeds, this, _1));

    // A lambda, on a topic whose name is a constant of another package.
    battery_sub_ = nh_.subscribe<sensor_msgs::BatteryState>(
        rover_core::topics::kBattery, 1, [this](const sensor_msgs::BatteryStateConstPtr& msg) { charge_ = msg->percentage; });

    // A node handle inside a node handle: the names below it start with `wheels/`.
    ros::NodeHandle wheels(nh_, "wheels");
    left_pub_ = wheels.advertise<std_msgs::Float64>("left/command", 1);
    right_pub_ = wheels.advertise<std_msgs::Float64>("right/command", 1);

    speeds_pub_.reset(new realtime_tools::RealtimePublisher<rover_core::WheelSpeeds>(private_nh_, "speeds_measured", 4));

    motor_power_ = nh_.serviceClient<std_srvs::SetBool>("motor_power");
    reset_srv_ = private_nh_.advertiseService("reset_odometry", &BaseController::onReset, this);

    updater_.setHardwareID("rover base");
    updater_.add("Battery", this, &BaseController::reportBattery);
    reconfigure_.setCallback(boost::bind(&BaseController::onReconfigure, this, _1, _2));
  }

protected:
  bool selfTest() override
  {
    std_srvs::SetBool power;
    power.request.data = true;
    return motor_power_.call(power) && power.response.success;
  }

  void stop() override
  {
    drive(0.0, 0.0);
  }

private:
  void onCommand(const geometry_msgs::Twist::ConstPtr& msg)
  {
    const double turn = msg->angular.z * wheel_separation_ / 2.0;
    drive((msg->linear.x - turn) / wheel_radius_, (msg->linear.x + turn) / wheel_radius_);
    updater_.update();
  }

  void onSpeeds(const rover_core::WheelSpeeds::ConstPtr& msg)
  {
    odometry_.update(*msg);
    if (speeds_pub_->trylock())
    {
      speeds_pub_->msg_ = *msg;
      speeds_pub_->unlockAndPublish();
    }
  }

  bool onReset(std_srvs::Empty::Request&, std_srvs::Empty::Response&)
  {
    return true;
  }

  void onReconfigure(DriveConfig& config, uint32_t)
  {
    max_speed_ = config.max_speed;
  }

  void reportBattery(diagnostic_updater::DiagnosticStatusWrapper& status)
  {
    status.add("charge", charge_);
  }

  void drive(double left, double right)
  {
    std_msgs::Float64 command;
    command.data = left;
    left_pub_.publish(command);
    command.data = right;
    right_pub_.publish(command);
  }

  double wheel_radius_, wheel_separation_, max_speed_ = 0.0, charge_ = 0.0;
  Odometry odometry_;
  diagnostic_updater::Updater updater_;
  dynamic_reconfigure::Server<DriveConfig> reconfigure_;
  std::unique_ptr<realtime_tools::RealtimePublisher<rover_core::WheelSpeeds>> speeds_pub_;
  ros::Publisher left_pub_, right_pub_;
  ros::Subscriber command_sub_, speeds_sub_, battery_sub_;
  ros::ServiceClient motor_power_;
  ros::ServiceServer reset_srv_;
};

}  // namespace rover_robot

int main(int argc, char** argv)
{
  ros::init(argc, argv, "base_controller");
  rover_robot::BaseController controller;
  ros::spin();
  return 0;
}
