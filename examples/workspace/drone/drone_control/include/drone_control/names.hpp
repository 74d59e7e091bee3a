#pragma once

namespace drone_control::names
{

inline constexpr char kState[] = "state";
inline constexpr auto kReturnHome = "/fleet/return_home";

}  // namespace drone_control::names
