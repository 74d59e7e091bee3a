#pragma once

#include <std_srvs/srv/trigger.hpp>

#include <string>

struct StopService {
  using Type = std_srvs::srv::Trigger;
  static std::string name() { return "/stop"; }
};
