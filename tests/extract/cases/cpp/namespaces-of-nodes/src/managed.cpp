#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <std_msgs/msg/string.hpp>

// The options stand where a namespace could, with a truth value after them.
class Managed : public rclcpp_lifecycle::LifecycleNode {
public:
  explicit Managed(const rclcpp::NodeOptions& options) : LifecycleNode("managed", options, true) {
    relative_ = create_publisher<std_msgs::msg::String>("chatter", 10);
  }

private:
  rclcpp_lifecycle::LifecyclePublisher<std_msgs::msg::String>::SharedPtr relative_;
};

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Managed>(outside::options())->get_node_base_interface());
}
