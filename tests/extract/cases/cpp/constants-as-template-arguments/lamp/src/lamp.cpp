#include <channels/channels.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_msgs/msg/float32.hpp>

namespace {

CHANNEL(light_switch, "light/switch", std_msgs::msg::Bool);
CHANNEL(light_power, "light/power", std_msgs::msg::Float32);

constexpr const char kLamp[] = "lamp";
std::shared_ptr<house::Lamp<kLamp>> lamp;

void switched(std_msgs::msg::Bool::ConstSharedPtr message) {
  lamp->output<light_power>()->publish(std_msgs::msg::Float32());
}

}  // namespace

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  lamp = std::make_shared<house::Lamp<kLamp>>();
  lamp->listen<light_switch>(switched);
  rclcpp::spin(lamp);
}
