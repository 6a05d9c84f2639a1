// What a sweep can vary: parameters of the chip and of the workload, and what else a run is asked.
#pragma once

#include <string>

#include "platform_models/loader/parameter.h"
#include "platform_models/loader/platform_file.h"
#include "platform_models/loader/value.h"
#include "workload/vio/parameters.h"

namespace leviosim::tools {

class KnownRuns;  // known_runs.h

struct SweepKey {
  enum class Kind {
    chip,             ///< "platform.cluster.clock"
    instruction_set,  ///< "platform.isa.base"
    workload,         ///< "workload.window"
    platform,         ///< name or file
    profile,
    data,   ///< ASL folder or "synthetic"
    trace,  ///< of recorded work
    seed,
    size,
    frames,
    cores
  };
  Kind kind = Kind::chip;
  std::string name;                           ///< as in the plan
  std::string path{};                         ///< of the chip's parameter: without "platform."
  const vio::Parameter* parameter = nullptr;  ///< of the workload

  /// Whether it may be varied over a range.
  bool is_number(const platform::Schema& schema) const;
  /// Whether recorded work already says it, so that a sweep over a trace cannot set it.
  bool belongs_to_recording() const;
};

/// @throws InputError at `place` with the nearest valid name
SweepKey find_key(const std::string& name, const platform::Schema& schema,
                  const platform::Place& place);

/// A number of a key as the plan gives it, and in which unit: that of the chip's file, none for
/// others.
struct SweepNumber {
  double value = 0;
  double factor = 1;  ///< base units in one of the unit
  std::string unit;

  std::string text() const;
};

/// The text of a value as all later steps use it: checked, numbers of the chip in the unit that the
/// reference platform gives them.
/// @throws InputError at `place`
std::string normal_value(const SweepKey& key, const std::string& text,
                         platform::PlatformFile& reference, const platform::Place& place);

/// The same value as a number; only for keys that are numbers.
SweepNumber number_of(const SweepKey& key, const std::string& text,
                      platform::PlatformFile& reference, const platform::Place& place);

/// A number of the chip in its reference unit. @param base  in base units
SweepNumber chip_number(const SweepKey& key, double base, platform::PlatformFile& reference);

/// "4units" → "4": what is counted says the name of the parameter. Others as they are.
std::string without_count_unit(const std::string& value);

}  // namespace leviosim::tools
