#include "relay.hpp"

#include <geometry_msgs/msg/pose.hpp>
#include <geometry_msgs/msg/pose_stamped.hpp>
#include <std_msgs/msg/string.hpp>

namespace templated
{
template <class In, class Out>
Relay<In, Out>::Relay(const std::string & name, const std::string & topic, const rclcpp::NodeOptions & options)
: Node(name, options)
{
  out_ = create_publisher<Out>(topic + "_out", 1);
  in_ = create_subscription<In>(topic, 1, [this](const typename In::ConstSharedPtr) {});
}

template class Relay<geometry_msgs::msg::PoseStamped, geometry_msgs::msg::Pose>;
template class Relay<std_msgs::msg::String, std_msgs::msg::String>;

class PoseRelay : public Relay<geometry_msgs::msg::PoseStamped, geometry_msgs::msg::Pose>
{
public:
  explicit PoseRelay(const rclcpp::NodeOptions & options) : Relay("pose_relay", "pose", options) {}
};

class TextRelay : public Relay<std_msgs::msg::String, std_msgs::msg::String>
{
public:
  explicit TextRelay(const rclcpp::NodeOptions & options) : Relay("text_relay", "text", options) {}
};
}  // namespace templated
