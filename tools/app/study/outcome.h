// What is kept of a point that was computed: figures, or why there are none. The same whether it
// has just been computed or was found in the cache.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace leviosim::tools {

struct Figure {
  std::string name;
  std::string unit;
  std::string description;
  double value = 0;
};

struct Outcome {
  std::string failure;  ///< why the point cannot be run to its end, such as too little L1
  std::vector<Figure> figures;
  std::string protocol{};  ///< of errors of trajectories among the figures
};

/// As JSON with every bit of the numbers.
std::string to_text(const Outcome& outcome);
/// Nothing for what to_text() never wrote, such as a file that was cut off.
std::optional<Outcome> parse_outcome(std::string_view text);

}  // namespace leviosim::tools
