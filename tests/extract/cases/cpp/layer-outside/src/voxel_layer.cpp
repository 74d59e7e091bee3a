#include <nav2_costmap_2d/costmap_layer.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <std_srvs/srv/empty.hpp>

namespace voxel_layer
{
class VoxelLayer : public nav2_costmap_2d::CostmapLayer
{
public:
  void onInitialize() override
  {
    auto node = node_.lock();
    declareParameter("enabled", rclcpp::ParameterValue(true));
    node->get_parameter(name_ + ".enabled", enabled_);
    declareParameter("sources", rclcpp::ParameterValue(std::string("")));
    node->get_parameter(name_ + ".sources", sources_);
    std::stringstream stream(sources_);
    std::string source;
    while (stream >> source) {
      declareParameter(source + "." + "height", rclcpp::ParameterValue(2.0));
    }
    service_ = node->create_service<std_srvs::srv::Empty>("reset_voxels", nullptr);
  }

private:
  bool enabled_;
  std::string sources_;
  rclcpp::Service<std_srvs::srv::Empty>::SharedPtr service_;
};
}  // namespace voxel_layer

PLUGINLIB_EXPORT_CLASS(voxel_layer::VoxelLayer, nav2_costmap_2d::Layer)
