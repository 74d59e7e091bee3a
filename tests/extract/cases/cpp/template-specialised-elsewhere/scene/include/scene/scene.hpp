#pragma once
#include <message_filters/subscriber.h>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/point_cloud2.hpp>

namespace scene
{
template<class T>
class Scene
{
public:
  explicit Scene(const rclcpp::Node::SharedPtr & given) : node(given) {}
  void setup(const std::string & topic);
  void repeat(const std::string & topic);

private:
  void plan(const typename T::ConstSharedPtr & message);
  rclcpp::Node::SharedPtr node;
  std::shared_ptr<message_filters::Subscriber<T>> subscriber;
};
}  // namespace scene
