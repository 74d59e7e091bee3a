#pragma once

#include <string>

// Each entry: name, help, type, default
#define CAMERA_PARAMETERS                                              \
  ENTRY(serial, "The serial number of the camera", std::string, std::string(""))  \
  ENTRY(fps, "Frames " + std::string("a second"), int, 5)              \
  ENTRY(depth_enabled, "Whether the depth camera runs (if it exists)", bool, true)

struct Parameters
{
#define ENTRY(variable, help, type, value) type variable;
  CAMERA_PARAMETERS
#undef ENTRY
};
