#include "scene/scene.hpp"

template<typename T>
void scene::Scene<T>::repeat(const std::string & topic)
{
  node->create_publisher<T>(topic, 1);
}

template<>
void scene::Scene<sensor_msgs::msg::PointCloud2>::plan(const sensor_msgs::msg::PointCloud2::ConstSharedPtr &)
{
  node->get_parameter("table.height").as_double();
}

template<>
void scene::Scene<sensor_msgs::msg::PointCloud2>::setup(const std::string & topic)
{
  subscriber = std::make_shared<message_filters::Subscriber<sensor_msgs::msg::PointCloud2>>(node, topic);
  subscriber->registerCallback(&scene::Scene<sensor_msgs::msg::PointCloud2>::plan, this);
}

template class scene::Scene<sensor_msgs::msg::PointCloud2>;
