#include <rclcpp/rclcpp.hpp>

struct Settings
{
  std::string frame{};
  std::vector<std::string> names = {};
  double speed{};
  int count = {};
  bool on{};
};

class Reader : public rclcpp::Node
{
public:
  Reader() : Node("n")
  {
    declare_parameter("frame", settings_.frame);
    declare_parameter("names", settings_.names);
    declare_parameter("speed", settings_.speed);
    declare_parameter("count", settings_.count);
    declare_parameter("on", settings_.on);
    std::string text = "first";
    text = {};
    declare_parameter("text", text);
    get_parameter_or("other", text, {});
    const std::vector<std::pair<std::string, std::string>> pairs{{"empty", {}}, {"full", "x"}};
    for (const auto & [name, value] : pairs) {
      declare_parameter(name, value);
    }
  }

private:
  Settings settings_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Reader>());
}
