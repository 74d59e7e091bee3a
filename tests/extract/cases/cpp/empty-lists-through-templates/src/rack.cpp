// The default of a parameter is an empty list, whose type only the call of a template shows.
#include <rclcpp/rclcpp.hpp>

template <typename Node, typename Value>
Value obtain(Node node, const std::string & name, const Value & preset)
{
  if (node->has_parameter(name)) {
    rclcpp::Parameter found(name, preset);
    node->get_parameter(name, found);
    return found.get_value<Value>();
  }
  return node->declare_parameter(name, rclcpp::ParameterValue{preset}).template get<Value>();
}

class Rack : public rclcpp::Node
{
public:
  Rack() : rclcpp::Node("rack")
  {
    shelves_ = obtain(this, "shelves", std::vector<std::string>());
    heights_ = obtain(this, "heights", heights_);
    depths_ = obtain(this, "depths", std::vector<int64_t>{});
  }

private:
  std::vector<std::string> shelves_;
  std::vector<double> heights_{};
  std::vector<int64_t> depths_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Rack>());
}
