#include <ros/ros.h>
#include <sensor_msgs/Imu.h>
int main(int argc, char** argv) {
  ros::init(argc, argv, "camera");
  ros::NodeHandle nh("~");
  camera::Model model = camera::model();
  std::string imu_topic;
  if (model != camera::Model::ONE) {
    imu_topic = "imu/data";
  }
  ros::Publisher imu;
  if (camera::has_imu(model)) {
    imu = nh.advertise<sensor_msgs::Imu>(imu_topic, 1);
  }
  imu.publish(sensor_msgs::Imu());
  ros::spin();
}
