// One limit of a budget, as a file says it: "frame latency p99 <= 45 ms", "cycles <= +3 %". What it
// is about stands in figures.h, what a run makes of it in check.h.
#pragma once

#include <string>

#include "platform_models/loader/value.h"

namespace leviosim::tools {

/// What a figure is held against.
struct Bound {
  bool at_most = true;    ///< "<=", else ">="
  bool relative = false;  ///< to the baseline: the text has a sign
  double number = 0;
  std::string unit;  ///< as written; empty: none
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

}  // namespace leviosim::tools
