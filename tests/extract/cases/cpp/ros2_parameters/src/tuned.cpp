#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

#include <tuning_utils/parameters.hpp>

namespace declared
{
class Tuned : public rclcpp::Node
{
public:
  explicit Tuned(const rclcpp::NodeOptions & options) : Node("tuned", options)
  {
    rate_ = declare_parameter("rate", 20.0);
    names_ = this->declare_parameter<std::vector<std::string>>("names", {"a", "b"});
    limit_ = declare_parameter<int>("limits.upper");
    declare_parameters<double>("gain", {{"p", 1.5}, {"i", 0.0}});
    mode_ = get_or_declare_parameter<std::string>(*this, "mode", "fast");
    tuning_utils::declare_parameter_if_not_declared(this, "frame", rclcpp::ParameterValue("base_link"));
    get_parameter("frame", frame_);
    const auto several = get_parameters({"rate", "mode"});
    const auto topic = declare_parameter<std::string>("output_topic", "out");
    pub_ = create_publisher<std_msgs::msg::String>(topic, 1);
    framed_ = create_publisher<std_msgs::msg::String>(frame_ + "/state", 1);
    set_parameter(rclcpp::Parameter("rate", 5.0));
    declare_parameter("host", rclcpp::ParameterType::PARAMETER_STRING);
    declare_parameter("ports", rclcpp::PARAMETER_INTEGER_ARRAY);
    rclcpp::Parameter span;
    get_parameter_or("span", span, rclcpp::Parameter("span", 6.5));
  }

private:
  std::string frame_;
};
}  // namespace declared
