#include "parts.hpp"

int main(int argc, char** argv)
{
  ros::init(argc, argv, "first");
  First first;
  ros::Publisher other = common(first.nh_);
  ros::spin();
}
