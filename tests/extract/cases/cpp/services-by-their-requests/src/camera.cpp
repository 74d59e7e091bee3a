#include "my_camera/camera.h"

namespace my_camera
{

Camera::Camera(ros::NodeHandle & handle)
{
  exposure_ = handle.advertiseService("exposure", &Camera::exposure, this);
  gain_ = handle.advertiseService<GetNumberRequest, GetNumberResponse>(
    "gain", [](GetNumberRequest & request, GetNumberResponse & response) { return true; });
  power_ = handle.advertiseService<std_srvs::SetBoolRequest, std_srvs::SetBoolResponse>(
    "power", [](std_srvs::SetBoolRequest & request, std_srvs::SetBoolResponse & response) { return true; });
  member_ = handle.advertiseService("member", &Camera::member, this);
  GetNumberRequest request;
  GetNumberResponse response;
  ros::service::call("called", request, response);
  members_ = handle.serviceClient<NumberRequest>("members");
}

bool Camera::exposure(GetNumberRequest & request, GetNumberResponse & response) { return true; }

bool Camera::member(NumberRequest::Request & request, NumberRequest::Response & response) { return true; }

}  // namespace my_camera
