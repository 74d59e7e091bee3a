#include <rclcpp/rclcpp.hpp>
#include <vendor/types.h>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/imu.hpp>

enum VendorMode { VENDOR_MODE_DISABLED, VENDOR_MODE_ON };

struct Output {
  VendorId id;
  VendorMode mode;
};

std::string topic_of(VendorId id) {
  switch (id) {
    case VENDOR_IMU: return "imu";
    case VENDOR_IMAGE: return "image";
    default: return "undefined";
  }
}

class Store {
public:
  template <typename T>
  T get(const rclcpp::Node& node, std::string key, int value) const {
    if (node.has_parameter(key)) {
      int parameter;
      node.get_parameter_or<int>(key, parameter, value);
      return static_cast<T>(parameter);
    } else {
      return static_cast<T>(value);
    }
  }
  void add(const rclcpp::Node& node, const std::string& key, VendorId id) {
    Output output;
    output.id = id;
    output.mode = get<VendorMode>(node, key, VENDOR_MODE_DISABLED);
    outputs.push_back(output);
  }
  std::vector<Output> outputs;
};

void create(rclcpp::Node& node, VendorId id, VendorMode mode, const std::string& topic,
            rclcpp::Publisher<sensor_msgs::msg::Imu>::SharedPtr& imu, rclcpp::Publisher<sensor_msgs::msg::Image>::SharedPtr& image) {
  if (mode != VENDOR_MODE_DISABLED) {
    switch (id) {
      case VENDOR_IMU:
        imu = node.create_publisher<sensor_msgs::msg::Imu>(topic, 10);
        break;
      case VENDOR_IMAGE:
        image = node.create_publisher<sensor_msgs::msg::Image>(topic, 10);
        break;
    }
  }
}

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("driver");
  rclcpp::NodeOptions options;
  options.automatically_declare_parameters_from_overrides(true);
  rclcpp::Node parameters("parameters", "", options);
  Store store;
  store.add(parameters, "output.imu", VENDOR_IMU);
  store.add(parameters, "output.image", VENDOR_IMAGE);
  rclcpp::Publisher<sensor_msgs::msg::Imu>::SharedPtr imu;
  rclcpp::Publisher<sensor_msgs::msg::Image>::SharedPtr image;
  for (const Output& output : store.outputs) {
    create(*node, output.id, output.mode, topic_of(output.id), imu, image);
  }
  rclcpp::spin(node);
}
