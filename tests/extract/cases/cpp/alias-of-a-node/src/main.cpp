#include <node_with_part.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/range.hpp>

class Sonar {
 public:
  explicit Sonar(rclcpp::Node& node) : range_(node.create_publisher<sensor_msgs::msg::Range>("range", 10)) {}

 private:
  rclcpp::Publisher<sensor_msgs::msg::Range>::SharedPtr range_;
};

using SonarNode = NodeWithPart<Sonar>;
using Program = SonarNode;

static const std::string kName = "sonar";

int main(int argc, char* argv[]) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Program>(kName));
  rclcpp::shutdown();
  return 0;
}
