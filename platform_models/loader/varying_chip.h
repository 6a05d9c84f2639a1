// One chip of which some parameters change a million times, when a sweep asks which of its points
// can be. A change costs what it changes, and nothing is said but yes or no: the reasons are those
// of PlatformFile::resolve().
#pragma once

#include <optional>
#include <string_view>

#include "platform_models/loader/document.h"
#include "platform_models/loader/schema.h"

namespace leviosim::platform {

class VaryingChip {
 public:
  /// @param settings  of a chip that has passed check_rules(); outlived by the schema
  VaryingChip(const Schema& schema, Settings settings);

  /// The value that `text` gives the parameter, as -p reads it, in base units or as the index of a
  /// choice; nothing if it is none.
  std::optional<double> value_of(std::size_t field, std::string_view text) const;

  /// Changes a parameter that the chip gives. @param text  of a choice
  void set(std::size_t field, double value, std::string_view text);

  /// Whether it passes check_rules().
  bool is_possible() const;

  const Settings& settings() const { return settings_; }
  /// Ends of ranges aside.
  const sim::ChipConfig& config() const { return config_; }

 private:
  const Schema& schema_;
  Settings settings_;
  sim::ChipConfig config_;
};

}  // namespace leviosim::platform
