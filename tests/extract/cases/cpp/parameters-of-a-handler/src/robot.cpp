#include <functional>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <vector>

enum class Mode : std::uint8_t { UNSPECIFIED = 0, POSITION, TORQUE = 4 };

class Handler
{
  class Base
  {
  public:
    Base(const std::string & name, rclcpp::node_interfaces::NodeParametersInterface::SharedPtr interface)
    : name_(name), interface_(interface)
    {
    }
    const std::string & name() const { return name_; }
    const rclcpp::ParameterValue & value() const { return value_; }
    rclcpp::node_interfaces::NodeParametersInterface::SharedPtr interface() const { return interface_; }
    virtual void block() = 0;

  protected:
    void set(rclcpp::ParameterValue && value) { value_ = value; }
    const std::string name_;

  private:
    rclcpp::node_interfaces::NodeParametersInterface::SharedPtr interface_;
    rclcpp::ParameterValue value_;
  };

  template <typename T>
  class Parameter : public Base
  {
  public:
    Parameter(
      const std::string & name, const T & value, std::function<bool(const T &)> changed,
      rclcpp::node_interfaces::NodeParametersInterface::SharedPtr interface)
    : Base(name, interface), changed_(changed)
    {
      set(rclcpp::ParameterValue(value));
    }
    void block() override
    {
      changed_ = [this](const T &) { return false; };
    }

  private:
    std::function<bool(const T &)> changed_;
  };

public:
  template <typename T>
  void add(
    const std::string & name, const T & value, std::function<bool(const T &)> changed,
    rclcpp::node_interfaces::NodeParametersInterface::SharedPtr interface, bool fixed = false)
  {
    auto parameter = std::make_shared<Handler::Parameter<T>>(name, value, changed, interface);
    add(parameter, fixed);
  }

private:
  std::vector<std::shared_ptr<Base>> parameters_;
  void add(std::shared_ptr<Base> parameter, bool fixed)
  {
    parameters_.emplace_back(parameter);
    parameter->interface()->declare_parameter(parameter->name(), parameter->value());
    if (fixed) {
      parameter->block();
    }
  }
};

class RobotBase : public rclcpp::Node
{
public:
  RobotBase() : Node("robot") { handler_ = Handler(); }

  template <typename T>
  void add(const std::string & name, const T & value, std::function<bool(const T &)> changed)
  {
    handler_.add<T>(name, value, changed, this->get_node_parameters_interface());
  }
  template <typename T>
  void add_fixed(const std::string & name, const T & value, std::function<bool(const T &)> changed)
  {
    handler_.add<T>(name, value, changed, this->get_node_parameters_interface(), true);
  }

private:
  Handler handler_;
};

class Robot : public RobotBase
{
public:
  Robot()
  {
    add_fixed<std::vector<std::string>>(
      "models", std::vector<std::string>{"small"}, [this](const std::vector<std::string> &) { return true; });
    add<int>("mode", static_cast<int>(Mode::POSITION), [this](int mode) { return set(mode); });
    add<int>("torque", static_cast<int>(Mode::TORQUE), [this](int mode) { return set(mode); });
    add<std::string>("address", "localhost", [this](const std::string &) { return true; });
    add<std::vector<double>>("stiffness", stiffness_, [this](const std::vector<double> &) { return true; });
    add_fixed<bool>("simulated", false, [this](const bool simulated) { return !simulated; });
  }

private:
  bool set(int mode) { return mode > 0; }
  std::vector<double> stiffness_ = std::vector<double>(3, 100.0);
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Robot>());
}
