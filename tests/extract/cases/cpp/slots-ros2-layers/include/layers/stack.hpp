#pragma once
#include <memory>
#include <string>
#include <vector>

#include <pluginlib/class_loader.hpp>
#include <rclcpp/rclcpp.hpp>

namespace layers
{
class Layer
{
public:
  virtual ~Layer() = default;
  virtual void initialize(rclcpp::Node::SharedPtr node, const std::string & name) = 0;
};

class Stack : public rclcpp::Node
{
public:
  explicit Stack(const std::string & name);

private:
  pluginlib::ClassLoader<Layer> loader_{"layers", "layers::Layer"};
  std::vector<std::string> names_, default_names_, types_;
};
}  // namespace layers
