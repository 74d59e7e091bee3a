#include <case/node.hpp>
#include <std_msgs/msg/bool.hpp>

namespace blocker
{
class Blocker : public rclcpp::Node
{
public:
  Blocker(const std::string & name, const rclcpp::NodeOptions & options) : rclcpp::Node(name, options)
  {
    blocked_ = create_publisher<std_msgs::msg::Bool>("blocked", 1);
  }

private:
  rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr blocked_;
};

std::shared_ptr<rclcpp::Node> make_node(const rclcpp::NodeOptions & options)
{
  return make_node("blocker_node", options);
}

std::shared_ptr<rclcpp::Node> make_node(const std::string & name, const rclcpp::NodeOptions & options)
{
  return std::make_shared<Blocker>(name, options);
}
}  // namespace blocker
