#include <rclcpp/rclcpp.hpp>
#include <nav_msgs/msg/path.hpp>
#include <std_msgs/msg/string.hpp>
#include "tools/interfaces.hpp"

class App : public tools::Node
{
public:
  App() : tools::Node("app")
  {
    method_ = create_publisher<std_msgs::msg::String>("a", rclcpp::QoS(5));
    function_ = tools::create_publisher<std_msgs::msg::String>(this, "b", tools::FastQoS());
    usual_ = tools::create_publisher<nav_msgs::msg::Path>(this, "c");
    latched_ = rclcpp::Node::create_publisher<nav_msgs::msg::Path>("d", tools::LatchedQoS(7));
    rate_ = tools::declare(this, "rate", 10.0);
  }

private:
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr method_, function_;
  rclcpp::Publisher<nav_msgs::msg::Path>::SharedPtr usual_, latched_;
  double rate_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<App>());
  return 0;
}
