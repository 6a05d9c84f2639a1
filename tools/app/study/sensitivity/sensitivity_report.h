// The table and the file of `leviosim sensitivity`.
#pragma once

#include <string>
#include <vector>

#include "tools/app/study/sensitivity/sensitivity.h"

namespace leviosim::tools {

/// The largest effects first; numbers without any effect are only named.
/// As parts of a screen.
std::vector<std::string> sensitivity_tables(const Sensitivity& sensitivity, int workers);

/// The number with the largest effect, in a sentence.
std::string sensitivity_conclusion(const Sensitivity& sensitivity);

/// A row per number with both ends of its range, times in ms, changes in per cent.
std::string sensitivity_csv(const Sensitivity& sensitivity);

}  // namespace leviosim::tools
