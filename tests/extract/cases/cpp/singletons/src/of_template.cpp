#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

template <typename T>
class Singleton
{
public:
  static T & get()
  {
    static std::shared_ptr<T> one(new T());
    return *one;
  }
  static std::shared_ptr<T> once()
  {
    std::call_once(flag_, [&] {made_ = std::make_shared<T>();});
    return made_;
  }

private:
  inline static std::once_flag flag_;
  inline static std::shared_ptr<T> made_;
};

class Sender : public rclcpp::Node
{
public:
  Sender() : Node("sender") {}
  void open(const std::string & topic) {sent_ = create_publisher<std_msgs::msg::String>(topic, 1);}

private:
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr sent_;
};

class Tools
{
public:
  void use(Sender & sender) {sender.open("by_tools");}
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  Singleton<Sender>::get().open("got");
  Singleton<Tools>::once()->use(Singleton<Sender>::get());
  Singleton<Sender>::once()->open("made_once");
  rclcpp::shutdown();
}
