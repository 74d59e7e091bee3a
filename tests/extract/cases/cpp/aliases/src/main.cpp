#include "aliases/filter.h"

int main(int argc, char** argv)
{
  ros::init(argc, argv, "filter");
  Filter filter(ros::NodeHandle());
  ros::spin();
  return 0;
}
