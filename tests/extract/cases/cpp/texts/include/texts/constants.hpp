#pragma once
#include <string>
#define DEFINED "defined"

namespace texts
{
constexpr char kConstant[] = "header/constant";

struct Names
{
  static const std::string MEMBER;
  static constexpr const char* kEnumerated = "enumerated";
};
}  // namespace texts
