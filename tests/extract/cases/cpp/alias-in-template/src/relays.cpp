#include <geometry_msgs/msg/pose.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

template <class Message>
struct Output
{
  explicit Output(rclcpp::Node & node, const std::string & topic) { out = node.create_publisher<Message>(topic, 1); }
  typename rclcpp::Publisher<Message>::SharedPtr out;
};

// The alias means another type in each class that the template makes.
template <class Message>
struct Relay
{
  using Sender = Output<Message>;
  Relay(rclcpp::Node & node, const std::string & topic)
  {
    Sender sender(node, topic);
  }
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::Node node("relays");
  Relay<std_msgs::msg::String> texts(node, "text");
  Relay<geometry_msgs::msg::Pose> poses(node, "pose");
  rclcpp::spin(node.get_node_base_interface());
}
