#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_msgs/msg/int32.hpp>
class A : public rclcpp::Node {
public:
  explicit A(const std::string & name) : Node(name) {
    state_ = create_publisher<std_msgs::msg::Bool>("state", 1);
    own_ = create_publisher<std_msgs::msg::Int32>("~/own", 1);
    declare_parameter("rate", 1);
  }
  rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr state_;
  rclcpp::Publisher<std_msgs::msg::Int32>::SharedPtr own_;
};
int main(int argc, char ** argv) {
  rclcpp::init(argc, argv);
  auto one = std::make_shared<A>("one");
  auto two = std::make_shared<A>("two");
  auto three = rclcpp::Node::make_shared("three");
  auto sub = three->create_subscription<std_msgs::msg::Bool>("state", 1, [](std_msgs::msg::Bool::SharedPtr) {});
  rclcpp::executors::SingleThreadedExecutor e;
  e.add_node(one); e.add_node(two); e.add_node(three);
  e.spin();
}
