#include <future>
#include <memory>
#include <string>
#include <vector>

#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <sensor_msgs/msg/range.hpp>

class Sonar {
 public:
  Sonar(rclcpp::Node::SharedPtr node, const std::string& name)
      : publisher_(node->create_publisher<sensor_msgs::msg::Range>(name, 1)) {}
  static std::vector<std::shared_ptr<Sonar>> all(rclcpp::Node::SharedPtr node);
  void start(rclcpp::Node::SharedPtr node) {
    echo_ = node->create_subscription<sensor_msgs::msg::Range>("echo", 1, [](sensor_msgs::msg::Range::SharedPtr) {});
  }

 private:
  rclcpp::Publisher<sensor_msgs::msg::Range>::SharedPtr publisher_;
  rclcpp::Subscription<sensor_msgs::msg::Range>::SharedPtr echo_;
};

std::vector<std::shared_ptr<Sonar>> Sonar::all(rclcpp::Node::SharedPtr node) {
  return {std::make_shared<Sonar>(node, "front"), std::make_shared<Sonar>(node, "back")};
}

void measure(rclcpp::Node::SharedPtr node, std::string name) {
  node->create_publisher<sensor_msgs::msg::Imu>(name, 1);
}

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("board");
  auto sonars = std::async(std::launch::async, Sonar::all, node);
  auto imu = std::async(measure, node, "imu");
  auto first = sonars.get().front();
  auto started = std::async(std::launch::async, &Sonar::start, first.get(), node);
  started.wait();
  rclcpp::spin(node);
}
