// Keeps the drone in the air: a managed node, so that the motors turn only while it is active.

#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include <geometry_msgs/msg/twist_stamped.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_action/rclcpp_action.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <std_srvs/srv/set_bool.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <tf2_ros/transform_broadcaster.h>

#include <drone_interfaces/action/fly_to.hpp>
#include <drone_interfaces/msg/flight_state.hpp>
#include <drone_interfaces/srv/set_home.hpp>

#include "drone_control/flight_parameters.hpp"
#include "drone_control/names.hpp"

namespace drone_control
{

using drone_interfaces::msg::FlightState;
using drone_interfaces::srv::SetHome;
using FlyTo = drone_interfaces::action::FlyTo;
using GoalHandle = rclcpp_action::ServerGoalHandle<FlyTo>;
using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;

class FlightController : public rclcpp_lifecycle::LifecycleNode
{
public:
  FlightController() : LifecycleNode("flight_controller") {}

  CallbackReturn on_configure(const rclcpp_lifecycle::State &) override
  {
    parameters_ = std::make_shared<flight::ParamListener>(shared_from_this());
    declare_parameter<bool>("simulated", false);

    // The newest state is kept for those who come late.
    state_pub_ = create_publisher<FlightState>(names::kState, rclcpp::QoS(1).transient_local());
    setpoint_pub_ = create_publisher<geometry_msgs::msg::TwistStamped>("~/setpoint", 10);

    imu_sub_ = create_subscription<sensor_msgs::msg::Imu>(
      "imu/data", rclcpp::SensorDataQoS(), [this](sensor_msgs::msg::Imu::ConstSharedPtr) {++samples_;});
    odometry_sub_ = create_subscription<nav_msgs::msg::Odometry>(
      "odometry", rclcpp::QoS(rclcpp::KeepLast(5)).best_effort(),
      std::bind(&FlightController::on_odometry, this, std::placeholders::_1));

    arm_srv_ = create_service<std_srvs::srv::SetBool>(
      "~/arm", std::bind(&FlightController::on_arm, this, std::placeholders::_1, std::placeholders::_2));
    home_srv_ = create_service<SetHome>(
      "set_home", [this](const SetHome::Request::SharedPtr request, SetHome::Response::SharedPtr response) {
        home_ = request->home;
        response->success = true;
      });
    return_home_ = create_client<std_srvs::srv::Trigger>(names::kReturnHome);

    fly_to_ = rclcpp_action::create_server<FlyTo>(
      shared_from_this(), "fly_to",
      [](const rclcpp_action::GoalUUID &, FlyTo::Goal::ConstSharedPtr) {
        return rclcpp_action::GoalResponse::ACCEPT_AND_EXECUTE;
      },
      [](const std::shared_ptr<GoalHandle>) {return rclcpp_action::CancelResponse::ACCEPT;},
      [this](const std::shared_ptr<GoalHandle> goal) {
        std::thread{[this, goal] {fly(goal);}}.detach();
      });
    broadcaster_ = std::make_unique<tf2_ros::TransformBroadcaster>(*this);
    return CallbackReturn::SUCCESS;
  }

private:
  void on_odometry(const nav_msgs::msg::Odometry::ConstSharedPtr msg)
  {
    geometry_msgs::msg::TransformStamped transform;
    transform.header = msg->header;
    transform.child_frame_id = parameters_->get_params().frame_id;
    broadcaster_->sendTransform(transform);
  }

  void on_arm(
    const std_srvs::srv::SetBool::Request::SharedPtr request, std_srvs::srv::SetBool::Response::SharedPtr response)
  {
    response->success = !request->data || samples_ > 0;
  }

  void fly(const std::shared_ptr<GoalHandle> & goal)
  {
    geometry_msgs::msg::TwistStamped setpoint;
    setpoint.twist.linear.x = goal->get_goal()->speed;
    setpoint_pub_->publish(setpoint);
    state_pub_->publish(FlightState());
    auto result = std::make_shared<FlyTo::Result>();
    result->arrived = true;
    goal->succeed(result);
  }

  size_t samples_ = 0;
  geometry_msgs::msg::Point home_;
  std::shared_ptr<flight::ParamListener> parameters_;
  std::unique_ptr<tf2_ros::TransformBroadcaster> broadcaster_;
  rclcpp_lifecycle::LifecyclePublisher<FlightState>::SharedPtr state_pub_;
  rclcpp_lifecycle::LifecyclePublisher<geometry_msgs::msg::TwistStamped>::SharedPtr setpoint_pub_;
  rclcpp::Subscription<sensor_msgs::msg::Imu>::SharedPtr imu_sub_;
  rclcpp::Subscription<nav_msgs::msg::Odometry>::SharedPtr odometry_sub_;
  rclcpp::Service<std_srvs::srv::SetBool>::SharedPtr arm_srv_;
  rclcpp::Service<SetHome>::SharedPtr home_srv_;
  rclcpp::Client<std_srvs::srv::Trigger>::SharedPtr return_home_;
  rclcpp_action::Server<FlyTo>::SharedPtr fly_to_;
};

}  // namespace drone_control

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<drone_control::FlightController>()->get_node_base_interface());
  rclcpp::shutdown();
  return 0;
}
