#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

class Sender : public rclcpp::Node
{
public:
  Sender()
  : Node("sender"),
#if DRIVER_HAS_INTERFACES
    driver_(
      get_node_base_interface()
#if DRIVER_HAS_NAMES
      ,
      "driver"
#endif
    ),
#else
    driver_(this),
#endif
    first_(create_publisher<std_msgs::msg::String>(
#ifdef LONG_NAMES
      "sender/first",
#else
      "first",
#endif
      1))
  {
    const bool wanted = declare_parameter("wanted", true)
#ifdef WITH_SWITCH
      && driver_.isOn()
#endif
      ;
    if (wanted) {
      second_ = create_publisher<std_msgs::msg::String>("second", 1);
    }
#ifdef WITH_THIRD
    third_ = create_publisher<std_msgs::msg::String>("third", 1);
#else
    third_ = create_publisher<std_msgs::msg::String>("other", 1);
#endif
  }

private:
  Driver driver_;
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr first_, second_, third_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Sender>());
}
