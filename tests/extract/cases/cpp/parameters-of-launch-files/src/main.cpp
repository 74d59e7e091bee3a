#include <rclcpp/rclcpp.hpp>

// A node that declares what launch files set may have a parameter that its code never declares; another has none.
template <class T>
void load(const std::shared_ptr<rclcpp::Node> &node, const std::string &name, T &value)
{
  if (node != nullptr && node->has_parameter(name)) {
    node->get_parameter<T>(name, value);
  }
}

int main(int argc, char **argv)
{
  rclcpp::init(argc, argv);
  rclcpp::NodeOptions options;
  options.allow_undeclared_parameters(true);
  options.automatically_declare_parameters_from_overrides(true);
  auto node = std::make_shared<rclcpp::Node>("open", options);
  int rate = 3;
  load(node, "rate", rate);

  auto closed = std::make_shared<rclcpp::Node>("closed");
  load(closed, "never", rate);
  closed->declare_parameter("size", 1);
  load(closed, "size", rate);
  rclcpp::spin(node);
}
