#pragma once

#include <rclcpp/rclcpp.hpp>
#include <rclcpp_action/rclcpp_action.hpp>
#include <rover/action/reach.hpp>
#include <rover/msg/joint_state2_d.hpp>
