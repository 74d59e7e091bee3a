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
    // A truth value without default, declared here or before.
    if (!has_parameter("debug")) {
      debug_ = declare_parameter<bool>("debug");
    } else {
      debug_ = get_parameter("debug").as_bool();
    }
    if (debug_) {
      pub_ = create_publisher<std_msgs::msg::String>("debug", 1);
    }
    if (!get_or_declare<bool>("quiet")) {
      pub_ = create_publisher<std_msgs::msg::String>("loud", 1);
    }
  }

private:
  template <class T>
  T get_or_declare(const std::string & name)
  {
    return has_parameter(name) ? get_parameter(name).get_value<T>() : declare_parameter<T>(name);
  }

  bool debug_;
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr pub_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Chooser>());
}
