#include <rclcpp/rclcpp.hpp>

using rclcpp::ParameterType::PARAMETER_STRING;

enum Mode { FAST = 1, SLOW = 2 };

class Tuned : public rclcpp::Node
{
public:
  Tuned() : Node("tuned")
  {
    declare_parameter("braced", std::vector<std::string>{});
    declare_parameter("called", std::vector<double>());
    declare_parameter("cast", static_cast<int>(Mode::FAST));
    declare_parameter("policy", (int)RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT);
    double seconds = period_.seconds();
    declare_parameter("variable", seconds);
    declare_parameter("member", names_);
    declare_parameter("stated", PARAMETER_STRING);
    put<int>("handed_down", static_cast<int>(Mode::SLOW));
  }

private:
  template <typename T>
  void put(const std::string & name, const T & value)
  {
    declare_parameter(name, rclcpp::ParameterValue(value));
  }

  rclcpp::Duration period_;
  std::vector<std::string> names_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Tuned>());
}
