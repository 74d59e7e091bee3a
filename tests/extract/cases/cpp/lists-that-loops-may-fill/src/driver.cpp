#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>
#include <vendor/bus.h>

std::vector<vendor::Device> devices_of(const std::string & model)
{
  std::vector<vendor::Device> found;
  for (const auto & bus : vendor::buses()) {
    if (bus.is_open()) {
      for (const auto & device : bus.devices()) {
        if (device.model() == model) {
          found.push_back(device);
        }
      }
    }
  }
  return found;
}

void split(std::vector<std::string> & parts, const std::string & text, char sign)
{
  std::stringstream stream(text);
  std::string part;
  while (getline(stream, part, sign)) {
    if (part.size() > 0) {
      parts.push_back(part);
    }
  }
}

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("driver");
  auto devices = devices_of("scanner");
  if (devices.size() < 2) {
    throw std::runtime_error("the driver needs two devices");
  }
  std::vector<std::string> version;
  split(version, devices[0].version(), '.');
  if (version.size() < 3) {
    return 1;
  }
  auto publisher = node->create_publisher<std_msgs::msg::String>("scan", 1);
  rclcpp::spin(node);
}
