#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

class Context
{
public:
  static std::shared_ptr<Context> get(rclcpp::Node::SharedPtr node = nullptr)
  {
    if (!instance_) {
      instance_ = std::shared_ptr<Context>(new Context(node));
      ++count_;
    }
    return instance_;
  }
  void start()
  {
    sent_ = node_->create_publisher<std_msgs::msg::String>("sent_" + std::to_string(count_), 1);
  }

private:
  explicit Context(rclcpp::Node::SharedPtr node) : node_(node) {}
  inline static std::shared_ptr<Context> instance_;
  inline static int count_ = 0;
  rclcpp::Node::SharedPtr node_;
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr sent_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = rclcpp::Node::make_shared("in_class");
  Context::get(node);
  Context::get()->start();
  rclcpp::spin(node);
}
