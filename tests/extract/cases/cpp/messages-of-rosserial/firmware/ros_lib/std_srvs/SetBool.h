#ifndef _ROS_SERVICE_SetBool_h
#define _ROS_SERVICE_SetBool_h

#include <stdint.h>
#include "ros/msg.h"

namespace std_srvs
{
class SetBoolRequest : public ros::Msg
{
public:
  bool data;
};

class SetBoolResponse : public ros::Msg
{
public:
  bool success;
};

class SetBool
{
public:
  typedef SetBoolRequest Request;
  typedef SetBoolResponse Response;
};
}  // namespace std_srvs

#endif
