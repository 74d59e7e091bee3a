#include <cstdlib>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <sensor_msgs/msg/range.hpp>

template <typename Message>
class Plain {
 public:
  explicit Plain(const std::string& topic) : topic_(topic) {}
  void reset(rclcpp::Node* node) { publisher_ = node->create_publisher<Message>(topic_, 10); }

 private:
  std::string topic_;
  typename rclcpp::Publisher<Message>::SharedPtr publisher_;
};

class Sonar {
 public:
  explicit Sonar(const std::vector<std::string>& topics) : topics_(topics) {}
  void reset(rclcpp::Node* node) {
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      publishers_.push_back(node->create_publisher<sensor_msgs::msg::Range>(topics_[i], 10));
    }
  }

 private:
  std::vector<std::string> topics_;
  std::vector<rclcpp::Publisher<sensor_msgs::msg::Range>::SharedPtr> publishers_;
};

// Anything with a method `reset` is an output.
class Output {
 public:
  template <typename T>
  Output(const T& held) : held_(std::make_shared<Model<T>>(held)) {}
  void reset(rclcpp::Node* node) { held_->reset(node); }

 private:
  struct Concept {
    virtual ~Concept() {}
    virtual void reset(rclcpp::Node* node) = 0;
  };

  template <typename T>
  struct Model : public Concept {
    Model(const T& held) : held_(held) {}
    void reset(rclcpp::Node* node) { held_->reset(node); }
    T held_;
  };

  std::shared_ptr<Concept> held_;
};

class Outputs : public rclcpp::Node {
 public:
  Outputs() : Node("outputs") {
    if (std::getenv("IMU")) add("imu", std::make_shared<Plain<sensor_msgs::msg::Imu>>("imu"));
    std::vector<std::string> topics;
    if (std::getenv("WHEELS")) {
      topics.push_back("sonar/front");
      topics.push_back("sonar/back");
    } else {
      topics.push_back("sonar/left");
      topics.push_back("sonar/right");
    }
    add("sonar", std::make_shared<Sonar>(topics));
    for (std::map<std::string, Output>::value_type& one : outputs_) {
      one.second.reset(this);
    }
  }

 private:
  void add(const std::string& name, Output output) {
    outputs_.insert(std::map<std::string, Output>::value_type(name, output));
  }

  std::map<std::string, Output> outputs_;
};

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Outputs>());
  return 0;
}
