#include <fstream>

void save(const std::string & share)
{
  std::ofstream file(share + "/data/poses.yaml");
  file << "poses: []";
}
