#pragma once
#include <demo_msgs/msg/mode.hpp>
#include <std_srvs/srv/trigger.hpp>

namespace specs
{
struct CurrentMode
{
  using Message = demo_msgs::msg::Mode;
  static constexpr char name[] = "/system/mode";
};

struct Restart
{
  using Service = std_srvs::srv::Trigger;
  static constexpr char name[] = "/system/restart";
};
}  // namespace specs
