#include <functional>
#include <memory>
#include <string>

#include <autoware_utils/ros/debug_publisher.hpp>
#include <cuda_blackboard/cuda_blackboard_publisher.hpp>
#include <cuda_blackboard/cuda_blackboard_subscriber.hpp>
#include <cuda_blackboard/cuda_image.hpp>
#include <cuda_blackboard/cuda_pointcloud2.hpp>
#include <rclcpp/rclcpp.hpp>
#include <visualization_msgs/msg/marker_array.hpp>

visualization_msgs::msg::MarkerArray draw(double height);

class KerbFinder : public rclcpp::Node
{
public:
  KerbFinder() : Node("kerb_finder")
  {
    debug_ = std::make_unique<autoware_utils::DebugPublisher>(this, "~/debug");
    edges_ = std::make_unique<cuda_blackboard::CudaBlackboardPublisher<cuda_blackboard::CudaPointCloud2>>(
      *this, "~/edges");
    image_ = std::make_shared<cuda_blackboard::CudaBlackboardSubscriber<cuda_blackboard::CudaImage>>(
      *this, "image", std::bind(&KerbFinder::on_image, this, std::placeholders::_1));
  }

private:
  void on_image(std::shared_ptr<const cuda_blackboard::CudaImage> image)
  {
    debug_->publish("markers", draw(1.0));
    debug_->publish<std_msgs::msg::Float64>("height", 1.0);
  }

  std::unique_ptr<autoware_utils::DebugPublisher> debug_;
  std::unique_ptr<cuda_blackboard::CudaBlackboardPublisher<cuda_blackboard::CudaPointCloud2>> edges_;
  std::shared_ptr<cuda_blackboard::CudaBlackboardSubscriber<cuda_blackboard::CudaImage>> image_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<KerbFinder>());
  rclcpp::shutdown();
  return 0;
}
