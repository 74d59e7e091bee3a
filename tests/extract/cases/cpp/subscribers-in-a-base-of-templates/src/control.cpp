#include <std_msgs/Bool.h>
#include <std_msgs/Int32.h>
#include "timeout.h"

class Control {
public:
  Control(ros::NodeHandle &nh) : enable_{nh}, count_{nh} {
    enable_.subscribe("enable", 1, nullptr, [this]() { stop(); }, ros::Duration(1.0));
    count_.subscribe("count", 1, &Control::count, this, &Control::stop, this, ros::Duration(1.0));
  }

private:
  void count(const std_msgs::Int32::ConstPtr &) {}
  void stop() {}

  Timed<std_msgs::Bool> enable_;
  Timed<std_msgs::Int32> count_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "control");
  ros::NodeHandle nh;
  Control control(nh);
  ros::spin();
}
