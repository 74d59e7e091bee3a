#include "rclcpp/rclcpp.hpp"
#include "std_msgs/msg/string.hpp"
#include "settings_library/macros.hpp"

#define SENDER_SETTINGS \
  SETTING_MEMBER(period, int, 1000) \
  SETTING_MEMBER(text, std::string, "hello")

struct Settings
{
  SETTINGS_DEFINE_MEMBERS(SENDER_SETTINGS)
};

class Sender : public rclcpp::Node
{
public:
  Sender()
  : Node("sender")
  {
    out_ = create_publisher<std_msgs::msg::String>("out", 1);
  }

private:
  Settings settings_;
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr out_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Sender>());
}
