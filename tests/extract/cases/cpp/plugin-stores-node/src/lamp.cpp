#include <pluginlib/class_list_macros.hpp>
#include <rclcpp/rclcpp.hpp>

namespace lamp_plugin
{
class Device
{
public:
  virtual ~Device() = default;
  virtual double brightness(int steps) = 0;
  virtual void configure(const rclcpp::Node::WeakPtr & parent) = 0;
  virtual void switchOn() = 0;
};

class Lamp : public Device
{
public:
  // Computes, and reaches no effect.
  double brightness(int steps) override
  {
    double sum = 0.0;
    for (int step = 0; step < steps; ++step) {
      sum += 1.0 / (step + 1);
    }
    return sum;
  }

  // Reaches no effect either, but stores what another method uses.
  void configure(const rclcpp::Node::WeakPtr & parent) override {node_ = parent.lock();}

  void switchOn() override {node_->declare_parameter("lamp.colour", "white");}

private:
  rclcpp::Node::SharedPtr node_;
};
}  // namespace lamp_plugin

PLUGINLIB_EXPORT_CLASS(lamp_plugin::Lamp, lamp_plugin::Device)
