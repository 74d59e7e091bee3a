#pragma once
#include <demo_msgs/msg/mode.hpp>
#include <std_srvs/srv/trigger.hpp>

namespace specs
{
struct CurrentMode
{
  using Message = demo_msgs::msg::Mode;
  static constexpr char name[] = "/system/mode";
  static constexpr size_t depth = 3;
  static constexpr auto reliability = RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT;
  static constexpr auto durability = RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL;
};

struct Restart
{
  using Service = std_srvs::srv::Trigger;
  static constexpr char name[] = "/system/restart";
};
}  // namespace specs
