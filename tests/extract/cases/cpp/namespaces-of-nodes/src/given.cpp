#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

class Given : public rclcpp::Node {
public:
  Given(const std::string& space, const rclcpp::NodeOptions& options) : Node("given", space, options) {
    relative_ = create_publisher<std_msgs::msg::String>("chatter", 10);
    absolute_ = create_publisher<std_msgs::msg::String>("/abs", 10);
  }

private:
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr relative_, absolute_;
};

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Given>(read_namespace(), rclcpp::NodeOptions()));
}
