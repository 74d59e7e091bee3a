#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

class Chooser : public rclcpp::Node
{
public:
  Chooser() : Node("chooser")
  {
    const auto kind = declare_parameter<std::string>("kind");
    declare_parameter("count", rclcpp::PARAMETER_INTEGER);
    if (declare_parameter("rate", 1.0) < 0.0) {
      throw std::runtime_error("rate must not be negative");
    }
    if (kind == "robot") {
      pub_ = create_publisher<std_msgs::msg::String>("robot", 1);
    } else {
      pub_ = create_publisher<std_msgs::msg::String>("other", 1);
    }
    if (get_parameter("count").as_int() >= 2) {
      pub_ = create_publisher<std_msgs::msg::String>("several", 1);
    }
  }

private:
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr pub_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Chooser>());
}
