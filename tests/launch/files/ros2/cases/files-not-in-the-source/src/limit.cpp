#include <yaml-cpp/yaml.h>

YAML::Node limits(const std::string & share) { return YAML::LoadFile(share + "/data/limits.yaml"); }
