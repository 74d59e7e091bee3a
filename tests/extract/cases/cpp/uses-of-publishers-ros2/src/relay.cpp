#include <map>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/image.hpp>

class Relay : public rclcpp::Node
{
public:
  Relay() : Node("relay")
  {
    unused_ = create_publisher<sensor_msgs::msg::Image>("unused", 1);
    out_ = create_publisher<sensor_msgs::msg::Image>("out", 1);
    filled_ = create_publisher<nav_msgs::msg::Odometry>("filled", 1);
    copied_ = create_publisher<nav_msgs::msg::Odometry>("copied", 1);
    in_ = create_subscription<sensor_msgs::msg::Image>(
      "in", 1, [this](const sensor_msgs::msg::Image& image) { out_->publish(image); });
    odometry_ = create_subscription<nav_msgs::msg::Odometry>(
      "odom", 1, std::bind(&Relay::moved, this, std::placeholders::_1));
    kept_["front"] = create_publisher<sensor_msgs::msg::Image>("front", 1);
  }

  void on_activate() { unused_->on_activate(); }

private:
  void moved(nav_msgs::msg::Odometry::SharedPtr odometry)
  {
    nav_msgs::msg::Odometry whole;
    whole.pose = odometry->pose;
    fill(whole);
    filled_->publish(whole);
    nav_msgs::msg::Odometry again = *odometry;
    again.pose = odometry->pose;
    copied_->publish(again);
    for (auto& one : kept_) one.second->publish(sensor_msgs::msg::Image());
  }

  void fill(nav_msgs::msg::Odometry& odometry);

  rclcpp::Publisher<sensor_msgs::msg::Image>::SharedPtr unused_, out_;
  rclcpp::Publisher<nav_msgs::msg::Odometry>::SharedPtr filled_, copied_;
  std::map<std::string, rclcpp::Publisher<sensor_msgs::msg::Image>::SharedPtr> kept_;
  rclcpp::Subscription<sensor_msgs::msg::Image>::SharedPtr in_;
  rclcpp::Subscription<nav_msgs::msg::Odometry>::SharedPtr odometry_;
};

int main(int argc, char** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Relay>());
  return 0;
}
