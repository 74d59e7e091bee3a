#include <string>
#include <vector>

#include <pluginlib/class_list_macros.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>

namespace lamp_plugin
{
class Lamp
{
public:
  explicit Lamp(const std::string & name) : name_(name) {}
  virtual ~Lamp() = default;
  virtual void init(rclcpp::Node * node) = 0;

  void advertise(rclcpp::Node * node, const std::vector<std::string> & sides)
  {
    // init one publisher for each side
    for (const auto & side : sides) {
      const auto topic = side.empty() ? name_ : name_ + "_" + side;
      publishers_.push_back(node->create_publisher<std_msgs::msg::Bool>(topic, 1));
    }
  }

private:
  std::string name_;
  std::vector<rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr> publishers_;
};

class RoofLamp : public Lamp
{
public:
  RoofLamp() : Lamp("roof_lamp") {}

  void init(rclcpp::Node * node) override { advertise(node, {""}); }
};
}  // namespace lamp_plugin

PLUGINLIB_EXPORT_CLASS(lamp_plugin::RoofLamp, lamp_plugin::Lamp)
