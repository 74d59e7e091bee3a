#include <pluginlib/class_loader.h>
#include <ros/ros.h>

#include <string>

namespace maps
{
class Layer;

class Layers
{
public:
  explicit Layers(std::string name) : loader_("maps", "maps::Layer")
  {
    ros::NodeHandle nh("~/" + name);
    XmlRpc::XmlRpcValue list;
    nh.getParam("plugins", list);
    for (int32_t i = 0; i < list.size(); ++i)
    {
      std::string id = static_cast<std::string>(list[i]["name"]);
      std::string type = static_cast<std::string>(list[i]["type"]);
      boost::shared_ptr<Layer> layer = loader_.createInstance(type);
      layer->initialize(name + "/" + id);
    }
  }

private:
  pluginlib::ClassLoader<Layer> loader_;
};
}  // namespace maps

int main(int argc, char** argv)
{
  ros::init(argc, argv, "map_server");
  maps::Layers near("near");
  maps::Layers far("far");
  ros::spin();
}
