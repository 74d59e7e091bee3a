#include <ros/ros.h>
#include <std_msgs/String.h>

// The names of a structured binding mean the elements: those that a function returns by reference stay the same objects.
template <typename Data>
class Guarded {
public:
  Guarded() = default;
  Data getData() const { return data_; }
  std::pair<Data&, std::unique_lock<std::mutex>> write() {
    std::unique_lock<std::mutex> guard{m};
    return {data_, std::move(guard)};
  }
private:
  Data data_;
  mutable std::mutex m;
};
struct Parameters { std::string a; std::string b; };
class Mapper {
  Guarded<Parameters> parameters_;
  ros::NodeHandle nh;
public:
  void read() {
    auto [parameters, guard] = parameters_.write();
    nh.param("a_topic", parameters.a, std::string("/points"));
    nh.param("b_topic", parameters.b, std::string("/pose"));
  }
  void go() {
    const Parameters parameters{parameters_.getData()};
    ros::Subscriber s = nh.subscribe<std_msgs::String>(parameters.a, 1, [&](const auto& m){});
    auto [p2, g2]{parameters_.write()};
    ros::Subscriber s2 = nh.subscribe<std_msgs::String>(p2.b, 1, [&](const auto& m){});
  }
};
int main(int argc, char** argv)
{
  ros::init(argc, argv, "server");
  Mapper m;
  m.read();
  m.go();
}
