#include "case/sender.h"

int main(int argc, char** argv)
{
  ros::init(argc, argv, "sender");
  ros::NodeHandle nh;
  senders::Sender<int> sender;
  sender.init(nh);
  ros::spin();
}
