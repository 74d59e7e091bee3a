#include "layers/stack.hpp"

namespace layers
{
Stack::Stack(const std::string & name) : Node(name), default_names_{"walls", "doors"}
{
  std::vector<std::string> default_types{"layers::Walls", "layers::Doors"};
  names_ = declare_parameter("plugins", default_names_);
  for (size_t i = 0; i < default_names_.size(); ++i) {
    declare_parameter(default_names_[i] + ".plugin", default_types[i]);
  }
  for (const auto & one : names_) {
    types_.push_back(get_parameter(one + ".plugin").as_string());
  }
  for (unsigned int i = 0; i < names_.size(); ++i) {
    std::shared_ptr<Layer> layer = loader_.createSharedInstance(types_[i]);
    layer->initialize(shared_from_this(), names_[i]);
  }
}
}  // namespace layers
