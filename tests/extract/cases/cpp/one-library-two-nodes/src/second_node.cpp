#include "parts.hpp"

int main(int argc, char** argv)
{
  ros::init(argc, argv, "second");
  Second second;
  second.begin();
  ros::Publisher other = common(second.nh_);
  ros::spin();
}
