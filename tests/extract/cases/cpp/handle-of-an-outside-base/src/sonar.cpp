#include <gazebo/plugins/CameraPlugin.hh>
#include <gazebo_plugins/gazebo_ros_camera_utils.h>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Bool.h>

namespace gazebo
{
class Sonar : public SensorPlugin, GazeboRosCameraUtils
{
public:
  void Load(sensors::SensorPtr parent, sdf::ElementPtr sdf);
  virtual void Advertise();

private:
  ros::Publisher points_;
  event::ConnectionPtr connection_;
};

GZ_REGISTER_SENSOR_PLUGIN(Sonar)

void Sonar::Load(sensors::SensorPtr parent, sdf::ElementPtr sdf)
{
  SensorPlugin::Load(parent, sdf);
  connection_ = GazeboRosCameraUtils::OnLoad(boost::bind(&Sonar::Advertise, this));
  GazeboRosCameraUtils::Load(parent, sdf);
}

void Sonar::Advertise()
{
  auto options = ros::AdvertiseOptions::create<sensor_msgs::PointCloud2>(
    "points", 1, nullptr, nullptr, ros::VoidPtr(), &this->camera_queue_);
  this->points_ = this->rosnode_->advertise(options);
}
}  // namespace gazebo

class Lamp : public outside::Base
{
public:
  void start() override {this->state_ = this->handle_->advertise<std_msgs::Bool>("state", 1);}

private:
  ros::Publisher state_;
};

PLUGINLIB_EXPORT_CLASS(Lamp, outside::Base)
