#include <cmath>
#include <ros/ros.h>

class Limits {
public:
  static constexpr double kSpeed = 1.5;
  static constexpr double kTurn = M_PI / 4.0;
  static const int kRetries;
};

constexpr double Limits::kSpeed;
constexpr double Limits::kTurn;
const int Limits::kRetries = 3;

int main(int argc, char** argv) {
  ros::init(argc, argv, "driver");
  ros::NodeHandle nh("~");
  double speed, turn;
  int retries;
  nh.param("speed", speed, Limits::kSpeed);
  nh.param("turn", turn, Limits::kTurn);
  nh.param("retries", retries, Limits::kRetries);
  ros::spin();
}
