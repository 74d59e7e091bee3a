#include <pluginlib/class_list_macros.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>

namespace beeper_plugin
{
class Device
{
public:
  virtual ~Device() = default;
  // The loader calls `initialize` first.
  virtual bool readParameters() = 0;
  virtual void initialize(const rclcpp::Node::SharedPtr & node) = 0;
  virtual void start() = 0;
};

class Beeper : public Device
{
public:
  bool readParameters() override {return node_->get_parameter("beeper.topic", topic_);}

  void initialize(const rclcpp::Node::SharedPtr & node) override {node_ = node;}

  void start() override {publisher_ = node_->create_publisher<std_msgs::msg::Bool>(topic_, 1);}

private:
  rclcpp::Node::SharedPtr node_;
  std::string topic_;
  rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr publisher_;
};
}  // namespace beeper_plugin

PLUGINLIB_EXPORT_CLASS(beeper_plugin::Beeper, beeper_plugin::Device)
