#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

class Fixed : public rclcpp::Node {
public:
  Fixed() : rclcpp::Node("fixed", "robot", rclcpp::NodeOptions()) {
    relative_ = create_publisher<std_msgs::msg::String>("chatter", 10);
    private_ = create_publisher<std_msgs::msg::String>("~/status", 10);
    absolute_ = create_publisher<std_msgs::msg::String>("/abs", 10);
    own_ = create_publisher<std_msgs::msg::String>(std::string(get_namespace()) + "/own", 10);
  }

private:
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr relative_, private_, absolute_, own_;
};

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Fixed>());
}
