#pragma once
#include <nav_msgs/Odometry.h>
namespace names
{
using Position = nav_msgs::Odometry;
}
