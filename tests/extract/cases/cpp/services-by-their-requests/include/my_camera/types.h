#pragma once
#include <my_camera/GetNumber.h>
