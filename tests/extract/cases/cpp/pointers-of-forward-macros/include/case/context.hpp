#pragma once
#include <string>
#include <case/forward.hpp>

namespace application
{
CASE_CLASS_FORWARD(Application);
}

namespace capabilities
{
CASE_STRUCT_FORWARD(Context);

struct Context
{
  application::ApplicationPtr application_;
};

class Capability
{
public:
  virtual ~Capability() = default;
  virtual void initialize() = 0;
  void setContext(const ContextPtr& context)
  {
    context_ = context;
  }

protected:
  ContextPtr context_;
};
}  // namespace capabilities
