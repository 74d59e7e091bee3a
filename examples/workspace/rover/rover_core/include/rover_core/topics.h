#pragma once

#include <string>

// Names that several nodes of the rover agree on.

#define ROVER_STOP_TOPIC "/emergency_stop"

namespace rover_core
{
namespace topics
{
constexpr char kOdometry[] = "odom";
const std::string kBattery = "battery_state";
}  // namespace topics
}  // namespace rover_core
