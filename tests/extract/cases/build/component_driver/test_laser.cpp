// test_laser.cpp
