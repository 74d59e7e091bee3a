#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

class Mux : public rclcpp::Node {
public:
  Mux() : Node("mux", rclcpp::NodeOptions().automatically_declare_parameters_from_overrides(true)) {
    subscribe("inputs");
  }

private:
  void subscribe(const std::string& below) {
    const auto listed = list_parameters({below}, 10);
    for (const auto& prefix : listed.prefixes) {
      const auto topic = get_parameter(prefix + ".topic").as_string();
      inputs_.push_back(create_subscription<std_msgs::msg::String>(topic, 10, [](std_msgs::msg::String::SharedPtr) {}));
    }
  }

  std::vector<rclcpp::SubscriptionBase::SharedPtr> inputs_;
};

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Mux>());
}
