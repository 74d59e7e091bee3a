#pragma once
#include <ros/ros.h>
#include <std_srvs/SetBool.h>
#include "types.h"

namespace my_camera
{

class Camera
{
public:
  explicit Camera(ros::NodeHandle & handle);

private:
  bool exposure(GetNumberRequest & request, GetNumberResponse & response);

  bool member(NumberRequest::Request & request, NumberRequest::Response & response);

  ros::ServiceServer exposure_, gain_, power_, member_;
  ros::ServiceClient members_;
};

}  // namespace my_camera
