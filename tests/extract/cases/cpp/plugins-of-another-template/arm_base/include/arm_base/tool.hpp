#pragma once

#include <memory>

#include <class_loader/class_loader.hpp>
#include <rclcpp/rclcpp.hpp>

namespace arm
{
class Tool
{
public:
  explicit Tool(rclcpp::Node::SharedPtr given)
  : node(given) {}
  virtual ~Tool() = default;

protected:
  rclcpp::Node::SharedPtr node;
};

class Maker
{
public:
  virtual std::shared_ptr<Tool> make(rclcpp::Node::SharedPtr node) = 0;
};

template<typename T>
class MakerOf : public Maker
{
public:
  std::shared_ptr<Tool> make(rclcpp::Node::SharedPtr node) override {return std::make_shared<T>(node);}
};
}  // namespace arm

#define ARM_REGISTER(Class) CLASS_LOADER_REGISTER_CLASS(arm::MakerOf<Class>, arm::Maker)
