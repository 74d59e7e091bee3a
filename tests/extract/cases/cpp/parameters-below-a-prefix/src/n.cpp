#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/int32.hpp>

class Gains : public rclcpp::Node
{
public:
  Gains()
  : Node("gains", rclcpp::NodeOptions().automatically_declare_parameters_from_overrides(true))
  {
    std::map<std::string, double> gains;
    get_parameters("gains", gains);
    proportional_ = gains["p"];
    std::map<std::string, std::string> topics;
    if (get_parameters("topics", topics)) {
      for (const auto & topic : topics) {
        publishers_.push_back(create_publisher<std_msgs::msg::Int32>(topic.second, 1));
      }
    }
  }

private:
  double proportional_;
  std::vector<rclcpp::Publisher<std_msgs::msg::Int32>::SharedPtr> publishers_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Gains>());
}
