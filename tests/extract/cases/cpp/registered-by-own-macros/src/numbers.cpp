#include <pluginlib/class_list_macros.h>
#include <std_msgs/Int32.h>
#include <std_msgs/Float32.h>
#include "filter.h"

DECLARE_FILTER(Int32, "int");
DECLARE_FILTER_OF(Float, std_msgs::Float32, "float");
