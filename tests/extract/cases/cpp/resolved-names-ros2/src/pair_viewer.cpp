#include <memory>
#include <string>

#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/image.hpp>

class PairViewer : public rclcpp::Node
{
public:
  PairViewer() : Node("pair_viewer")
  {
    const auto base = get_node_base_interface();
    const std::string pair = base->resolve_topic_or_service_name("pair", false);
    const std::string view = base->resolve_topic_or_service_name("view", false);
    const auto callback = [](sensor_msgs::msg::Image::ConstSharedPtr) {};
    whole_ = create_subscription<sensor_msgs::msg::Image>(view, 1, callback);
    upper_ = create_subscription<sensor_msgs::msg::Image>(pair + "/upper" + view, 1, callback);
    lower_ = create_subscription<sensor_msgs::msg::Image>(
      pair + "/lower" + rclcpp::expand_topic_or_service_name("raw", get_name(), get_namespace()), 1, callback);
    own_ = create_publisher<sensor_msgs::msg::Image>(
      rclcpp::expand_topic_or_service_name("~/joined", get_name(), get_namespace()), 1);
  }

private:
  rclcpp::Subscription<sensor_msgs::msg::Image>::SharedPtr whole_, upper_, lower_;
  rclcpp::Publisher<sensor_msgs::msg::Image>::SharedPtr own_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<PairViewer>());
  rclcpp::shutdown();
  return 0;
}
