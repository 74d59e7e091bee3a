#include "parts.hpp"

First::First()
{
  publisher_ = nh_.advertise<std_msgs::String>("first", 1);
}
