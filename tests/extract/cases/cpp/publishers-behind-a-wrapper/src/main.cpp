#include <rclcpp/rclcpp.hpp>
#include <map>
#include <std_msgs/msg/string.hpp>
struct Wrapper {
  struct Concept { virtual ~Concept() {} virtual void reset(rclcpp::Node* node) = 0; };
  template <typename T> struct Model : Concept {
    Model(const T& other) : held_(other) {}
    void reset(rclcpp::Node* node) { held_->reset(node); }
    T held_;
  };
  template <typename T> Wrapper(const T& pub) : pub_(std::make_shared<Model<T>>(pub)) {}
  void reset(rclcpp::Node* node) { pub_->reset(node); }
  std::shared_ptr<Concept> pub_;
};
struct Pub {
  Pub(const std::string& topic) : topic_(topic) {}
  void reset(rclcpp::Node* node) { pub_ = node->create_publisher<std_msgs::msg::String>(topic_, 10); }
  std::string topic_;
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr pub_;
};
class Camera : public rclcpp::Node {
public:
  Camera() : Node("camera") {
    auto a = std::make_shared<Pub>("direct");
    Wrapper w(a);
    w.reset(this);
    auto b = std::make_shared<Pub>("implicit");
    add(b);
    auto c = std::make_shared<Pub>("mapped");
    names_.insert(std::map<std::string, std::shared_ptr<Pub>>::value_type("c", c));
    auto d = std::make_shared<Pub>("paired");
    names_.insert(std::make_pair("d", d));
    auto f = std::make_shared<Pub>("emplaced");
    names_.emplace("f", f);
    auto g = std::make_shared<Pub>("braced");
    names_.insert({"g", g});
    for (auto& one : names_) one.second->reset(this);
    auto e = std::make_shared<Pub>("map_of_wrappers");
    put("x", e);
    typedef std::map<std::string, Wrapper> map_t;
    for (map_t::value_type& one : wrapped_) one.second.reset(this);
  }
  void add(Wrapper w) { w.reset(this); }
  void put(const std::string& name, Wrapper w) { wrapped_.insert(std::map<std::string, Wrapper>::value_type(name, w)); }
  std::map<std::string, std::shared_ptr<Pub>> names_;
  std::map<std::string, Wrapper> wrapped_;
};
int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Camera>());
}
