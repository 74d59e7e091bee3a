#include <memory>

#include "hardware.h"

std::unique_ptr<demo::Hardware> hardware;

int main(int argc, char** argv) {
  ros::init(argc, argv, "driver");
  ros::NodeHandle nh;
  ros::NodeHandle nh_priv("~");
  hardware.reset(new demo::Hardware);
  if (!hardware->init(nh, nh_priv)) return 1;
  ros::spin();
}
