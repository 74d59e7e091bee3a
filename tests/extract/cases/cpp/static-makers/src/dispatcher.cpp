#include <pointers/impl_ptr.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>

namespace tasks
{
// One static method calls another by its name alone; a maker that is not in the sources creates the implementation.
class Dispatcher
{
public:
  static std::shared_ptr<Dispatcher> named(const std::string & name);
  static std::shared_ptr<Dispatcher> on(const std::shared_ptr<rclcpp::Node> & node);

private:
  class Implementation;
  pointers::unique_impl_ptr<Implementation> implementation_;
};

class Dispatcher::Implementation
{
public:
  explicit Implementation(std::shared_ptr<rclcpp::Node> node)
  {
    state_ = node->create_publisher<std_msgs::msg::Bool>("state", 1);
  }

private:
  rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr state_;
};

std::shared_ptr<Dispatcher> Dispatcher::named(const std::string & name)
{
  return on(std::make_shared<rclcpp::Node>(name));
}

std::shared_ptr<Dispatcher> Dispatcher::on(const std::shared_ptr<rclcpp::Node> & node)
{
  auto made = std::make_shared<Dispatcher>();
  made->implementation_ = pointers::make_unique_impl<Implementation>(node);
  return made;
}
}  // namespace tasks

int main()
{
  auto dispatcher = tasks::Dispatcher::named("dispatcher");
}
