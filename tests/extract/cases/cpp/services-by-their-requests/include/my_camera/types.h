#pragma once
#include <my_camera/GetNumber.h>
#include <my_camera/NumberRequest.h>
