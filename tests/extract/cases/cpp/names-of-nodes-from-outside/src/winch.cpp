// A class of another library names the node.
#include <lifting_kit/base.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <std_msgs/msg/string.hpp>

namespace carts
{
class Winch : public lifting_kit::Base
{
public:
  explicit Winch(const rclcpp::NodeOptions & options) : lifting_kit::Base(options)
  {
    rope_ = create_publisher<std_msgs::msg::String>("~/rope", 1);
  }

private:
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr rope_;
};
}  // namespace carts
RCLCPP_COMPONENTS_REGISTER_NODE(carts::Winch)
