#include <case/application.hpp>
#include <case/context.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <std_srvs/srv/empty.hpp>

namespace capabilities
{
class ClearMap : public Capability
{
public:
  void initialize() override
  {
    service_ = context_->application_->getNode()->create_service<std_srvs::srv::Empty>("clear_map", callback);
  }

private:
  rclcpp::Service<std_srvs::srv::Empty>::SharedPtr service_;
};
}  // namespace capabilities

PLUGINLIB_EXPORT_CLASS(capabilities::ClearMap, capabilities::Capability)
