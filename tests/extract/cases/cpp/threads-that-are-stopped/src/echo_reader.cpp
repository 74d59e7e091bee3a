#include <thread>

#include <ros/ros.h>
#include <std_msgs/Float64.h>

class EchoReader
{
public:
  void start()
  {
    running_ = true;
    thread_ = new std::thread(&EchoReader::read, this);
  }

  void stop()
  {
    running_ = false;
    thread_->join();
  }

private:
  void read()
  {
    ROS_INFO("start (until stop (or shutdown))");
    while (running_ && ros::ok()) {
      publisher_ = handle_.advertise<std_msgs::Float64>("echo", 1);
    }
  }

  bool running_ = false;
  std::thread * thread_ = nullptr;
  ros::NodeHandle handle_;
  ros::Publisher publisher_;
};

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "echo_reader");
  EchoReader reader;
  reader.start();
  ros::waitForShutdown();
  reader.stop();
}
