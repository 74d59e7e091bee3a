#include <company_utils/lifecycle_node.hpp>
#include <std_msgs/msg/string.hpp>

class Recorder : public company_utils::CompanyLifecycleNode
{
public:
  explicit Recorder(const rclcpp::NodeOptions & options) : company_utils::CompanyLifecycleNode(options) {}
  company_utils::CallbackReturn handle_on_configure(const rclcpp_lifecycle::State &)
  {
    plan_ = create_subscription<std_msgs::msg::String>("plan", 1, [](const std_msgs::msg::String &) {});
    return company_utils::CallbackReturn::SUCCESS;
  }

private:
  company_utils::SubPtr<std_msgs::msg::String> plan_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<Recorder>(rclcpp::NodeOptions());
  rclcpp::executors::MultiThreadedExecutor executor;
  executor.add_node(node->get_node_base_interface());
  executor.spin();
}
