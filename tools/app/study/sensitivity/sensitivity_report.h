// The table and the file of `leviosim sensitivity`.
#pragma once

#include <string>

#include "tools/app/study/sensitivity/sensitivity.h"

namespace leviosim::tools {

/// The largest effects first; numbers without any effect are only named.
std::string sensitivity_table(const Sensitivity& sensitivity, int workers);

/// A row per number with both ends of its range, times in ms, changes in per cent.
std::string sensitivity_csv(const Sensitivity& sensitivity);

}  // namespace leviosim::tools
