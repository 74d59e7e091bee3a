#ifndef INPUT_H
#define INPUT_H

#include <std_msgs/Bool.h>

#include "mixer.h"

class Input
{
public:
  Input(ros::NodeHandle& nh, const std::string& topic)
  {
    subscriber_ = nh.subscribe(topic, 1, &Input::received, this);
  }

  void received(const std_msgs::BoolConstPtr&) {}

private:
  ros::Subscriber subscriber_;
};

#endif
