#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>
#include <vendor/disk.hpp>

using String = std_msgs::msg::String;

class Recorder : public rclcpp::Node {
public:
  Recorder() : Node("recorder") {
    bool enabled = declare_parameter("enabled", true);
    try {
      vendor::mount();
    } catch (const std::exception&) {
      enabled = false;
    }
    // It is enabled where this runs, unless mounting failed.
    if (!enabled) {
      RCLCPP_INFO(get_logger(), "off");
    } else {
      images_ = create_publisher<String>("images", 10);
    }
    const bool fast = declare_parameter("fast", false), quiet = declare_parameter("quiet", false);
    // Neither holds on the other side of "or".
    if (fast || quiet) {
      some_ = create_publisher<String>("some", 10);
    } else {
      neither_ = create_publisher<String>("neither", 10);
    }
    // What the other side of "and" needs is not a list of parameters.
    if (fast && quiet) {
      both_ = create_publisher<String>("both", 10);
    } else {
      not_both_ = create_publisher<String>("not_both", 10);
    }
    if (!(fast && vendor::is_mounted())) {
      slow_ = create_publisher<String>("slow", 10);
    } else {
      mounted_ = create_publisher<String>("mounted", 10);
    }
    if (!fast || quiet) {
      return;
    }
    loud_ = create_publisher<String>("loud", 10);
  }

private:
  rclcpp::Publisher<String>::SharedPtr images_, some_, neither_, both_, not_both_, slow_, mounted_, loud_;
};

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Recorder>());
}
