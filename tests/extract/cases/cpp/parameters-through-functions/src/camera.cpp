#include <rclcpp/rclcpp.hpp>

static const std::string GAIN{"gain"};

template<class T>
T declared(rclcpp::Node & node, const std::string & name, const T & value)
{
  return node.declare_parameter<T>(name, value);
}

template<class T>
T bounded(rclcpp::Node & node, const std::string & name, const T & value)
{
  return std::max(declared<T>(node, name, value), value);
}

class Camera : public rclcpp::Node
{
public:
  Camera() : Node("camera")
  {
    bounded<double>(*this, GAIN, 1.5);
    for (const std::string stream : {"color", "depth"}) {
      const std::string name = stream + "_width";
      declared<int>(*this, name, 640);
    }
    declare_parameter("frame");
    frame_ = get_parameter("frame").as_string();
    rate_ = get_parameter("rate").get_value<double>();
    levels_ = get_parameter("levels").as_integer_array();
  }

private:
  std::string frame_;
  double rate_;
  std::vector<int64_t> levels_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Camera>());
}
