#include <pluginlib/class_list_macros.hpp>
#include <rclcpp/rclcpp.hpp>

namespace bell_plugin
{
class Device
{
public:
  virtual ~Device() = default;
  virtual void configure(const rclcpp::Node::SharedPtr & node, const std::string & name) = 0;
};

class Settings
{
public:
  Settings(const rclcpp::Node::SharedPtr & node, const std::string & prefix)
  : node_(node), prefix_(prefix) {}

  double get(const std::string & name, double otherwise)
  {
    const auto full = prefix_.empty() ? name : prefix_ + "." + name;
    node_->declare_parameter(full, otherwise);
    return otherwise;
  }

private:
  rclcpp::Node::SharedPtr node_;
  std::string prefix_;
};

class Bell : public Device
{
public:
  void configure(const rclcpp::Node::SharedPtr & node, const std::string & name) override
  {
    volume_ = Settings(node, name).get("volume", 0.5);
    if (name == "") {
      node->declare_parameter("never", 1);
    }
  }

private:
  double volume_;
};
}  // namespace bell_plugin

PLUGINLIB_EXPORT_CLASS(bell_plugin::Bell, bell_plugin::Device)
