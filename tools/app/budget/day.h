// Days of budgets and of accepted regressions.
#pragma once

#include <string>

namespace leviosim::tools {

/// "2026-12-24". @throws InputError that begins with `where`
std::string parse_day(const std::string& where, const std::string& text);

/// Of the clock in UTC, or what SOURCE_DATE_EPOCH in the environment says.
std::string today();

}  // namespace leviosim::tools
