#pragma once
#include <controller_interface/controller_interface.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp/rclcpp.hpp>
#include "bases/traits.hpp"

namespace bases
{
template <typename Hardware>
class Limits
{
public:
  explicit Limits(rclcpp_lifecycle::LifecycleNode::SharedPtr node) { node->declare_parameter<double>("speed", 1.0); }
};

template <>
class Limits<Steering>
{
public:
  explicit Limits(rclcpp_lifecycle::LifecycleNode::SharedPtr node);
};

template <typename Hardware>
class Controller : public controller_interface::ControllerInterface
{
  using Own = Traits<Hardware>;
  using Command = typename Traits<Hardware>::Command;

public:
  controller_interface::CallbackReturn on_init() override
  {
    auto node = get_node();
    limits_ = std::make_shared<Limits<Hardware>>(node);
    odometry_ = node->create_publisher<nav_msgs::msg::Odometry>(Own::odometry(), 1);
    commands_ = node->create_subscription<Command>(
      Traits<Hardware>::topic, 1, [](const typename Command::SharedPtr) {});
    extra();
    return controller_interface::CallbackReturn::SUCCESS;
  }
  void extra();

private:
  std::shared_ptr<Limits<Hardware>> limits_;
  rclcpp::Publisher<nav_msgs::msg::Odometry>::SharedPtr odometry_;
  typename rclcpp::Subscription<Command>::SharedPtr commands_;
};

using SteeringController = Controller<Steering>;
}  // namespace bases
