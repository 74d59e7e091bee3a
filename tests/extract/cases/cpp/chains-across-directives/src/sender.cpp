#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

using std_msgs::msg::String;

class Sender : public rclcpp::Node
{
public:
  Sender() : Node("sender")
  {
    int cameras = declare_parameter("cameras", 1);
    if (declare_parameter("many", false)) {
#ifdef WITH_MANY
      if (cameras == 2) {
        first_ = create_publisher<String>("two", 1);
      } else if (cameras == 3) {
        first_ = create_publisher<String>("three", 1);
      }
#else
      if (cameras > 1) {
        RCLCPP_FATAL(get_logger(), "not built for several");
      }
#endif
      else if (cameras == 0) {
        first_ = create_publisher<String>("any", 1);
      } else {
        first_ = create_publisher<String>("one", 1);
      }
    }
    if (cameras == 4) {
      second_ = create_publisher<String>("four", 1);
    }
#ifdef WITH_MANY
    else if (cameras == 5) {
      second_ = create_publisher<String>("five", 1);
    }
#endif
    else {
      second_ = create_publisher<String>("others", 1);
    }
    third_ = create_publisher<String>("last", 1);
  }

private:
  std::shared_ptr<void> first_, second_, third_;
};

int main(int argc, char** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Sender>());
}
