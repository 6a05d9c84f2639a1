#include "traces/work_traces/memory_budget.h"

#include <fmt/core.h>

#include <array>

namespace leviosim::traces {

std::string MemoryBudget::refusal(std::string_view what, std::uint64_t bytes) const {
  return fmt::format("{} would take {} of memory; {} of {} are left: --max-memory SIZE allows more",
                     what, memory_text(bytes), memory_text(ceiling_ - used_),
                     memory_text(ceiling_));
}

std::string memory_text(std::uint64_t bytes) {
  constexpr std::array kUnits{"B", "KiB", "MiB", "GiB", "TiB"};
  auto number = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; number >= 1024 && unit + 1 < kUnits.size(); ++unit) number /= 1024;
  return fmt::format("{:.{}f} {}", number, number < 10 && unit > 0 ? 1 : 0, kUnits[unit]);
}

}  // namespace leviosim::traces
