#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>

struct Span { double low, high; };

class Board : public rclcpp::Node {
public:
  Board() : Node("board") {
    settings_ = {
        this->declare_parameter("frame", "odom"),
        this->declare_parameter("cloud", false),
        Span{this->declare_parameter("low", 0.1), 2.0}};
    if (settings_.cloud) cloud_ = create_publisher<std_msgs::msg::Bool>("cloud", 10);
    frame_ = create_publisher<std_msgs::msg::Bool>("at/" + settings_.frame, 10);
  }
private:
  struct Settings {
    std::string frame = "map";
    bool cloud = false;
    Span span;
  } settings_{};
  rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr cloud_, frame_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Board>());
}
