#include "settings.h"
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/LaserScan.h>

void onScan(const sensor_msgs::LaserScan::ConstPtr& scan) {}
void onImu(const sensor_msgs::Imu::ConstPtr& imu) {}

int main(int argc, char** argv) {
  ros::init(argc, argv, "driver");
  ros::NodeHandle nh("~");
  readSettings(nh);
  ros::Subscriber scan = nh.subscribe(scan_topic, 1, onScan);
  ros::Subscriber imu;
  if (use_imu) {
    imu = nh.subscribe(imu_topic, 1, onImu);
  }
  ros::spin();
}
