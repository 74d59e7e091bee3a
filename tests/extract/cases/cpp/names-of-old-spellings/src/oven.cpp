#include <rclcpp/rclcpp.hpp>

std::shared_ptr<rclcpp::Node> node;

struct Heat {
  double top = 1.0;
};

template <typename T>
bool find(const std::initializer_list<const char*>& names, T& value) {
  for (const auto* name : names) {
    if (node->has_parameter(name) && node->get_parameter(name, value)) {
      return true;
    }
  }
  return false;
}

template <typename T>
void load(const std::initializer_list<const char*>& names, T& value, const T& otherwise) {
  if (find(names, value)) {
    return;
  }
  const auto* first = *names.begin();
  if (!node->has_parameter(first)) {
    node->declare_parameter<T>(first, otherwise);
  }
}

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  node = std::make_shared<rclcpp::Node>(
      "oven", rclcpp::NodeOptions().automatically_declare_parameters_from_overrides(true));
  Heat heat;
  load<double>({"heat.top", "heat/top"}, heat.top, 2.5);
  rclcpp::spin(node);
}
