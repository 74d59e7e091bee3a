#include <rclcpp/rclcpp.hpp>
#include <variant>
template <class... Ts>
struct overload : Ts... { using Ts::operator()...; };
class ParameterWrapper {
public:
  rclcpp::ParameterType mType;
  std::string mName;
  std::variant<int*, std::string*, bool*, double*> mData;
  std::variant<int, std::string, bool, double> mDefault;
  ParameterWrapper(std::string name, int& variable, int value = 0) : mType{rclcpp::ParameterType::PARAMETER_INTEGER}, mName{std::move(name)}, mData{&variable}, mDefault{value} {}
  ParameterWrapper(std::string name, std::string& variable, std::string value = "") : mType{rclcpp::ParameterType::PARAMETER_STRING}, mName{std::move(name)}, mData{&variable}, mDefault{std::move(value)} {}
  ParameterWrapper(std::string name, bool& variable, bool value = false) : mType{rclcpp::ParameterType::PARAMETER_BOOL}, mName{std::move(name)}, mData{&variable}, mDefault{value} {}
  ParameterWrapper(std::string name, double& variable, double value = 0.0) : mType{rclcpp::ParameterType::PARAMETER_DOUBLE}, mName{std::move(name)}, mData{&variable}, mDefault{value} {}
  void visit(rclcpp::Node* node) {
    std::visit(overload{
      [&](int* arg) { try { *arg = static_cast<int>(node->get_parameter(mName).as_int()); } catch (...) {} },
      [&](std::string* arg) { try { *arg = node->get_parameter(mName).as_string(); } catch (...) {} },
      [&](bool* arg) { try { *arg = node->get_parameter(mName).as_bool(); } catch (...) {} },
      [&](double* arg) { try { *arg = node->get_parameter(mName).as_double(); } catch (...) {} }}, mData);
  }
  static inline auto declareParameters(rclcpp::Node* node, std::vector<ParameterWrapper>& params) -> void {
    for (auto& param: params) {
      try { node->declare_parameter(param.mName, param.mType); } catch (rclcpp::exceptions::ParameterAlreadyDeclaredException const& e) {}
      param.visit(node);
    }
  }
};
class N : public rclcpp::Node {
  std::string mFrame, mOther; int mCount{}; double mRate{}; bool mOn{};
public:
  N() : Node("n") {
    std::vector<ParameterWrapper> params{
      {"frame", mFrame, "map"}, {"other", mOther}, {"count", mCount, 5}, {"rate", mRate, 1.0}, {"most", quantity.rep, std::numeric_limits<float>::infinity()}, {"on", mOn, true}, {"plain", mCount}};
    ParameterWrapper::declareParameters(this, params);
  }
};
int main(int argc, char** argv) { rclcpp::init(argc, argv); rclcpp::spin(std::make_shared<N>()); }
