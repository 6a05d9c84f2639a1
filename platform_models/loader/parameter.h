// One parameter of a platform with where its number comes from.
#pragma once

#include <optional>
#include <string>

namespace leviosim::platform {

/// Bounds of a sensitivity sweep, in the unit of the parameter.
struct Range {
  double low = 0;
  double high = 0;
};

struct Parameter {
  std::string path;   ///< "cluster.workers", "isa.ops.f32_add.issue": what -p takes
  std::string value;  ///< number or name, as text that reads back as the same value
  std::string unit;   ///< empty for names
  std::string source;
  std::string confidence;  ///< high, medium, low, assumed
  std::optional<Range> range;
  std::string note;
  std::string description;
  bool overridden = false;  ///< by -p
};

/// A parameter that was read, as a number for the chip's description.
struct Setting {
  Parameter parameter;
  double base = 0;    ///< value in the base unit of its dimension, or index of the name chosen
  std::string where;  ///< "gap9.yaml:12" or "-p cluster.workers=4": for messages about it
};

}  // namespace leviosim::platform
