#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>
#include <std_srvs/srv/empty.hpp>

class Talker : public rclcpp::Node {
public:
  Talker() : Node("talker") { publisher_ = create_publisher<std_msgs::msg::String>("~/state", 10); }
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr publisher_;
};

class Listener : public rclcpp::Node {
public:
  Listener() : Node("listener") {
    subscription_ = create_subscription<std_msgs::msg::String>("~/commands", 10, [](const std_msgs::msg::String&) {});
  }
  rclcpp::Subscription<std_msgs::msg::String>::SharedPtr subscription_;
};

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::executors::SingleThreadedExecutor executor;
  auto talker = std::make_shared<Talker>();
  auto listener = std::make_shared<Listener>();
  auto hidden = rclcpp::Node::make_shared("_caller");
  auto client = hidden->create_client<std_srvs::srv::Empty>("reset");
  executor.add_node(talker);
  executor.add_node(listener);
  executor.spin();
}
