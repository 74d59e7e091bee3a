// A part of the name is known.
#include <cstdlib>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

class Gauge : public rclcpp::Node
{
public:
  explicit Gauge(const std::string & side) : rclcpp::Node("gauge_" + side)
  {
    level_ = create_publisher<std_msgs::msg::String>("~/level", 1);
  }

private:
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr level_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Gauge>(std::getenv("SIDE")));
}
