#include <arm_core/gesture.hpp>
#include <arm_interfaces/action/wave.hpp>
#include <arm_node/node.hpp>
#include <pluginlib/class_list_macros.hpp>

namespace arm_plugins
{
class Wave : public arm_core::Gesture
{
public:
  void configure(const std::weak_ptr<arm_node::Node> & parent, arm_node::Monitor * monitor) override
  {
    auto node = parent.lock();
    node->make_server<arm_interfaces::action::Wave>("wave");
    limit_ = node->limit("wave_limit", 0.5);
    monitor->watch();
  }

private:
  double limit_;
};
}  // namespace arm_plugins

PLUGINLIB_EXPORT_CLASS(arm_plugins::Wave, arm_core::Gesture)
