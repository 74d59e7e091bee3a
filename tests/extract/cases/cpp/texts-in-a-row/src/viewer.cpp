#include <laser_proc/LaserPublisher.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

#include "device/settings.hpp"

#define TOPIC_HD "/hd"
#define TOPIC_COLOR "/color"
#define TOPIC_RECT "_rect"

class Viewer : public rclcpp::Node
{
public:
  Viewer() : Node("viewer")
  {
    std::string topic = TOPIC_HD TOPIC_COLOR TOPIC_RECT;
    first_ = create_publisher<std_msgs::msg::String>("/camera" + topic, 1);
    second_ = create_publisher<std_msgs::msg::String>(TOPIC_HD TOPIC_COLOR, 1);
    if (device::has("kind")) {
      kind_ = device::get("kind");
    }
    if (kind_ == "mono") {
      third_ = create_publisher<std_msgs::msg::String>("mono", 1);
    } else if (kind_.compare("stereo") == 0) {
      third_ = create_publisher<std_msgs::msg::String>("stereo", 1);
    }
    if (!kind_.empty()) {
      fourth_ = create_publisher<std_msgs::msg::String>(kind_, 1);
    }
    laser_ = std::make_unique<laser_proc::LaserPublisher>(get_node_topics_interface(), 20);
  }

private:
  std::string kind_;
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr first_, second_, third_, fourth_;
  std::unique_ptr<laser_proc::LaserPublisher> laser_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Viewer>());
}
