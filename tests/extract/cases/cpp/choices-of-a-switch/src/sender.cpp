#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <std_msgs/msg/string.hpp>
#include <string_view>

enum class Kind { None, Image, Imu, Text };

struct Entry
{
  Kind kind;
  std::string_view name;
};

static const Entry entries[] = {
  {Kind::Image, "picture"},
  {Kind::Imu, "motion"},
  {Kind::Text, "words"},
};

class Sender : public rclcpp::Node
{
public:
  Sender() : Node("sender")
  {
    declare_parameter("kinds", std::vector<std::string>());
    for (const auto & kind : get_parameter("kinds").as_string_array()) {
      add(kind);
    }
  }

private:
  void add(const std::string & wanted)
  {
    Kind kind = Kind::None;
    std::string_view topic;
    for (const auto & entry : entries) {
      if (entry.name == wanted) {
        kind = entry.kind;
        topic = entry.name;
      }
    }
    switch (kind) {
      case Kind::Image:
        publishers_.push_back(create_publisher<sensor_msgs::msg::Image>(std::string(topic), 1));
        break;
      case Kind::Imu:
        publishers_.push_back(create_publisher<sensor_msgs::msg::Imu>(std::string(topic), 1));
        break;
      case Kind::Text:
        publishers_.push_back(create_publisher<std_msgs::msg::String>(std::string(topic), 1));
        break;
      default:
        RCLCPP_ERROR(get_logger(), "unknown kind");
    }
  }

  std::vector<rclcpp::PublisherBase::SharedPtr> publishers_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Sender>());
}
