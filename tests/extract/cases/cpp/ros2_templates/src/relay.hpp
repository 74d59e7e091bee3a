#pragma once
#include <rclcpp/rclcpp.hpp>

namespace templated
{
template <class In, class Out>
class Relay : public rclcpp::Node
{
public:
  Relay(const std::string & name, const std::string & topic, const rclcpp::NodeOptions & options);

protected:
  typename rclcpp::Publisher<Out>::SharedPtr out_;
  typename rclcpp::Subscription<In>::SharedPtr in_;
};
}  // namespace templated
