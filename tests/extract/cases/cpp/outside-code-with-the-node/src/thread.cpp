#include <thread>
#include <ros/ros.h>
#include <voxel_maps/server.h>

// Nothing that a thread or a callback does is described, but it gives the node away.
class Mapper {
public:
  explicit Mapper(const ros::NodeHandle & nh) : nh_(nh) {}
  void run() { server_ = std::make_shared<voxel_maps::Server>(nh_); }

private:
  ros::NodeHandle nh_;
  std::shared_ptr<voxel_maps::Server> server_;
};

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "thread");
  ros::NodeHandle nh;
  Mapper mapper(nh);
  std::thread later([&mapper]() { mapper.run(); });
  ros::spin();
  later.join();
  return 0;
}
