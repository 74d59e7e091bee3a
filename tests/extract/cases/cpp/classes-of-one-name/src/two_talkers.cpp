#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

class Talker : public rclcpp::Node
{
public:
  Talker(const std::string& name, const std::string& topic) : Node(name)
  {
    publisher_ = create_publisher<std_msgs::msg::String>(topic, 10);
  }

private:
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr publisher_;
};

int main(int argc, char** argv)
{
  rclcpp::init(argc, argv);
  auto first = std::make_shared<Talker>("first", "a");
  auto second = std::make_shared<Talker>("second", "b");
  rclcpp::spin(first);
}
