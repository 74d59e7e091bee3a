// test/test_threshold.cpp
