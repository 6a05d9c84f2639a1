// A file of budgets (README.md): sections with limits, each for platforms and profiles. Strict:
// unknown keys and figures are refused with the nearest name, and every number has its unit.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "platform_models/loader/value.h"
#include "tools/app/record/record.h"

namespace leviosim::tools {

/// The bound of a limit.
struct Bound {
  bool at_most = true;    ///< "<=", else ">="
  bool relative = false;  ///< to the baseline: the text has a sign
  double number = 0;
  std::string unit;       ///< as written; empty: none
  std::string word = {};  ///< of a limit on a verdict, "fits on average"; has no number
};

struct Limit {
  std::string text;    ///< as written
  std::string stage;   ///< pattern of names of stages; empty: none
  std::string figure;  ///< a phrase of figures.h, or a pattern of names of statistics
  Bound bound;
  bool warns = false;  ///< is a warning if it is not met
  std::string reason;
  std::string owner;
  std::string file;
  int line = 0;
};

/// "FIGURE <= NUMBER UNIT". @throws InputError at `place`
Limit parse_limit(const std::string& text, const platform::Place& place);

/// Whether a text is what a pattern says, in which '*' stands for any text.
bool matches(const std::string& pattern, const std::string& text);

struct BudgetSection {
  std::string name;
  std::string platform = "*";  ///< pattern
  std::string profile = "*";   ///< pattern
  std::vector<Limit> limits;   ///< with reason and owner of the section where they have none
};

/// A limit that may be missed until a day, within another bound.
struct AcceptedMiss {
  std::string limit;             ///< title of what is held: "EPnP RANSAC: cycles <= +3 %"
  std::optional<Bound> bound{};  ///< that holds instead; verdicts have none
  std::string reason;
  std::string until;  ///< the last day, "2026-12-24"
  int line = 0;
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
