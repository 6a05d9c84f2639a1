// The camera of the EuRoC images after decimation (PARAMETERS.md#input).
#pragma once

#include "workload/math/vec.h"

namespace leviosim::vio::test {

inline constexpr PinholeCamera kCamera{114.66f, 114.32f, 77.80f, 62.09f};

}  // namespace leviosim::vio::test
