#pragma once
#include <memory>
#include <string>
#include <rclcpp/rclcpp.hpp>

namespace tools
{

class LatchedQoS : public rclcpp::QoS
{
public:
  explicit LatchedQoS(const size_t depth = 2) : rclcpp::QoS(depth)
  {
    transient_local();
    reliable();
  }
};

class FastQoS : public rclcpp::QoS
{
public:
  FastQoS() : rclcpp::QoS(rclcpp::KeepLast(3)) { best_effort(); }
};

template <typename MessageT, typename NodeT>
typename rclcpp::Publisher<MessageT>::SharedPtr create_publisher(
  const NodeT & node, const std::string & topic, const rclcpp::QoS & qos = LatchedQoS())
{
  auto options = rclcpp::PublisherOptions();
  return node->template create_publisher<MessageT>("~/" + topic, qos, options);
}

template <typename ParameterT, typename NodeT>
ParameterT declare(const NodeT & node, const std::string & name, const ParameterT & value)
{
  if (!node->has_parameter(name)) {
    return node->template declare_parameter<ParameterT>(name, value);
  }
  return node->get_parameter(name).template get_value<ParameterT>();
}

class Node : public rclcpp::Node
{
public:
  using rclcpp::Node::Node;

  template <typename MessageT>
  typename rclcpp::Publisher<MessageT>::SharedPtr create_publisher(
    const std::string & topic, const rclcpp::QoS & qos = rclcpp::SystemDefaultsQoS())
  {
    return tools::create_publisher<MessageT>(this, "method/" + topic, qos);
  }
};

}  // namespace tools
