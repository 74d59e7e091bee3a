#pragma once
#include <memory>

#define CASE_POINTERS(Name) \
  using Name##Ptr = std::shared_ptr<Name>; \
  using Name##ConstPtr = std::shared_ptr<const Name>;
#define CASE_CLASS_FORWARD(Name) \
  class Name; \
  CASE_POINTERS(Name)
#define CASE_STRUCT_FORWARD(Name) \
  struct Name; \
  CASE_POINTERS(Name)
