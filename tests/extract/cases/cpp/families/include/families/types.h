#pragma once
#include "families/estimator.h"
#include "families/linear.h"

typedef Estimator<Linear> LinearEstimator;
