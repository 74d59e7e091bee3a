#include <stdexcept>
#include <string>

#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_msgs/msg/color_rgba.hpp>

enum class Mode { Plain, Coloured, Invalid };

class LampDriver : public rclcpp::Node
{
public:
  LampDriver()
  : Node("lamp_driver")
  {
    const bool dimmed = declare_parameter<bool>("dimmed", false);
    std::string suffix = "none";
    switch (mode(declare_parameter<std::string>("mode"))) {
      case Mode::Plain: {
        suffix = "plain";
        lamp_ = create_publisher<std_msgs::msg::Bool>("lamp", 1);
        break;
      }
      case Mode::Coloured: {
        suffix = "coloured";
        if (dimmed) {
          suffix = "dim";
          break;
        }
        colour_ = create_publisher<std_msgs::msg::ColorRGBA>("colour", 1);
        break;
      }
      default:
        throw std::domain_error("the mode is not valid");
    }
    state_ = create_publisher<std_msgs::msg::Bool>("state/" + suffix, 1);
  }

private:
  static Mode mode(const std::string & name)
  {
    if (name == "plain") {
      return Mode::Plain;
    }
    return name == "coloured" ? Mode::Coloured : Mode::Invalid;
  }

  rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr lamp_, state_;
  rclcpp::Publisher<std_msgs::msg::ColorRGBA>::SharedPtr colour_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<LampDriver>());
  rclcpp::shutdown();
}
