#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float32.hpp>
#include <std_msgs/msg/string.hpp>

class Monitor : public rclcpp::Node
{
public:
  Monitor() : Node("monitor")
  {
    std::string topic;
    getParameters(topic);
    publisher_ = create_publisher<std_msgs::msg::String>(topic, 1);
  }

private:
  void getParameters(std::string & topic)
  {
    topic = declare_parameter("state_topic", "state");
  }
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr publisher_;
};

class Radius
{
public:
  explicit Radius(const rclcpp::Node::SharedPtr & node) : node_(node) {}
  void configure()
  {
    std::string topic;
    getParameters(topic);
    subscription_ = node_->create_subscription<std_msgs::msg::Float32>(topic, 1, [](std_msgs::msg::Float32) {});
  }

private:
  void getParameters(std::string & topic)
  {
    topic = node_->declare_parameter("radius_topic", "radius");
  }
  rclcpp::Node::SharedPtr node_;
  rclcpp::Subscription<std_msgs::msg::Float32>::SharedPtr subscription_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<Monitor>();
  Radius radius(node);
  radius.configure();
  rclcpp::spin(node);
}
