#include <company_utils/lifecycle_node.hpp>
#include <company_utils/monitored_node.hpp>
#include <std_msgs/msg/string.hpp>
#include <std_srvs/srv/trigger.hpp>

namespace demo
{
// The bases are not in the sources: a managed node, whose transitions call methods of the library's own names.
class Planner : public company_utils::CompanyLifecycleNode
{
public:
  explicit Planner(const rclcpp::NodeOptions & options);
  company_utils::CallbackReturn handle_on_configure(const rclcpp_lifecycle::State &);

private:
  void receive(const std_msgs::msg::String & message) {}

  company_utils::PubPtr<std_msgs::msg::String> plan_;
  company_utils::SubPtr<std_msgs::msg::String> goal_;
  company_utils::ServicePtr<std_srvs::srv::Trigger> reset_;
};

Planner::Planner(const rclcpp::NodeOptions & options)
: company_utils::CompanyLifecycleNode(options)
{
  declare_parameter<double>("rate", 10.0);
}

company_utils::CallbackReturn Planner::handle_on_configure(const rclcpp_lifecycle::State &)
{
  plan_ = create_publisher<std_msgs::msg::String>("plan", 1);
  goal_ = create_subscription<std_msgs::msg::String>("goal", 1, std::bind(&Planner::receive, this, std::placeholders::_1));
  reset_ = create_service<std_srvs::srv::Trigger>("reset", [](auto, auto) {});
  return company_utils::CallbackReturn::SUCCESS;
}

// A registered component is a node, whatever its base is.
class Monitor : public company_utils::Monitored
{
public:
  explicit Monitor(const rclcpp::NodeOptions & options)
  : company_utils::Monitored("monitor", options)
  {
    state_ = create_publisher<std_msgs::msg::String>("state", 1);
  }

private:
  company_utils::PubPtr<std_msgs::msg::String> state_;
};
}  // namespace demo
