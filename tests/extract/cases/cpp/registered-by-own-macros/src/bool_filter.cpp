#include <pluginlib/class_list_macros.h>
#include <std_msgs/Bool.h>
#include "filter.h"

DECLARE_FILTER(Bool, "bool")  // no semicolon
