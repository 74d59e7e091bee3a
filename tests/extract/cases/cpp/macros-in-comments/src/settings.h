#pragma once
#define PROBABILISTIC
// #define HASHED
//#define WITH_IMU  // the build file defines it
// #define PROBABILISTIC
// #define SIZE 10
