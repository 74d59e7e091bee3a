#include <filters/filter_chain.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>

class Scans
{
public:
  explicit Scans(rclcpp::Node::SharedPtr node) : chain_("sensor_msgs::msg::LaserScan"), other_("sensor_msgs::msg::LaserScan")
  {
    chain_.configure("", node->get_node_logging_interface(), node->get_node_parameters_interface());
    other_.configure("near", node->get_node_logging_interface(), node->get_node_parameters_interface());
  }

private:
  filters::FilterChain<sensor_msgs::msg::LaserScan> chain_;
  filters::FilterChain<sensor_msgs::msg::LaserScan> other_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = rclcpp::Node::make_shared("scans");
  Scans scans(node);
  rclcpp::spin(node);
}
