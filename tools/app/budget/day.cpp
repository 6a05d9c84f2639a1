#include "tools/app/budget/day.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <cstdlib>
#include <ctime>

#include "sim/base/error.h"

namespace leviosim::tools {

std::string parse_day(const std::string& where, const std::string& text) {
  std::tm day{};
  const char* const end = ::strptime(text.c_str(), "%Y-%m-%d", &day);
  const auto number = [](int value) { return static_cast<unsigned>(value); };
  const std::chrono::year_month_day date(std::chrono::year(day.tm_year + 1900),
                                         std::chrono::month(number(day.tm_mon + 1)),
                                         std::chrono::day(number(day.tm_mday)));
  if (end == nullptr || *end != '\0' || text.size() != 10 || !date.ok())  // February has no 30th
    throw InputError(fmt::format("{} '{}': expected a day such as 2026-12-24", where, text));
  return text;
}

std::string today() {
  const char* const epoch = std::getenv("SOURCE_DATE_EPOCH");
  const std::time_t now = epoch == nullptr ? std::time(nullptr) : std::atoll(epoch);
  return fmt::format("{:%Y-%m-%d}", fmt::gmtime(now));
}

}  // namespace leviosim::tools
