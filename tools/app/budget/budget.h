// A file of budgets (README.md): sections with limits, each for platforms and profiles. Strict:
// unknown keys and figures are refused with the nearest name, and every number has its unit.
#pragma once

#include <string>
#include <vector>

#include "tools/app/budget/limit.h"
#include "tools/app/comparison/run_record.h"

namespace leviosim::tools {

struct BudgetSection {
  std::string name;
  std::string platform = "*";  ///< pattern
  std::string profile = "*";   ///< pattern
  std::vector<Limit> limits;   ///< with reason and owner of the section where they have none
};

/// A limit that may be missed for a while.
struct AcceptedMiss {
  std::string limit;  ///< title of what is held: "EPnP RANSAC: cycles <= +3 %"
  std::string reason;
  std::string until;  ///< the last day, "2026-12-24"
};

struct Budget {
  std::string file;
  std::vector<BudgetSection> sections;
  std::vector<AcceptedMiss> accepted;
  /// What every budget holds unless a limit names that verdict: none may be the worst.
  BudgetSection verdicts;
};

/// @throws InputError with file, line and key
Budget parse_budget(const std::string& file, const std::string& text);
Budget read_budget(const std::string& file);

/// The sections for a run. @throws InputError if there is none: a gate must check something
std::vector<const BudgetSection*> sections_for(const Budget& budget, const RunRecord& run);

}  // namespace leviosim::tools
