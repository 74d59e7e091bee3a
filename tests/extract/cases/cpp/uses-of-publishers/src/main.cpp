#include "uses_of_publishers/driver.h"

int main(int argc, char** argv)
{
  ros::init(argc, argv, "driver");
  ros::NodeHandle nh;
  Driver driver(nh);
  while (ros::ok())
    driver.update();
  return 0;
}
