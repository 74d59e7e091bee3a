#ifndef _ROS_std_msgs_String_h
#define _ROS_std_msgs_String_h

#include <stdint.h>
#include "ros/msg.h"

namespace std_msgs
{
class String : public ros::Msg
{
public:
  const char * data;
};
}  // namespace std_msgs

#endif
