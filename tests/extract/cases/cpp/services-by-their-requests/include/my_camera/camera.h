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

  ros::ServiceServer exposure_, gain_, power_;
};

}  // namespace my_camera
