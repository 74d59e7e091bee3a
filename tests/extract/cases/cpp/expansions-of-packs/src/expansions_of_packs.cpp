#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_msgs/msg/int32.hpp>
#include <std_msgs/msg/string.hpp>
#include <vector>

template <typename... Types>
class Hub
{
public:
  explicit Hub(rclcpp::Node & node) : node_(node) { (add<Types>(), ...); }

private:
  template <typename T>
  void add()
  {
    publishers_.push_back(node_.create_publisher<T>("hub", 1));
  }

  rclcpp::Node & node_;
  std::vector<rclcpp::PublisherBase::SharedPtr> publishers_;
};

std::string sided(const std::string & name) { return "left/" + name; }

void watch(rclcpp::Node & node, const std::vector<std::string> & names)
{
  for (const auto & name : names) {
    node.create_subscription<std_msgs::msg::Int32>(name, 1, [](std_msgs::msg::Int32::SharedPtr) {});
  }
}

template <typename... Names>
void offer(rclcpp::Node & node, const Names &... names)
{
  (node.create_subscription<std_msgs::msg::Bool>(names, 1, [](std_msgs::msg::Bool::SharedPtr) {}), ...);
  watch(node, {sided(names)...});
}

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("packs");
  Hub<std_msgs::msg::Int32, std_msgs::msg::String> two(*node);
  Hub<std_msgs::msg::Bool> one(*node);
  offer(*node, "first", "second", "third");
  rclcpp::spin(node);
}
