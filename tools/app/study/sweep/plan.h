// The file that a sweep is asked for in (README.md): what all points have in common, and groups of
// points. A group is the product of its members, the sweep all groups one after the other.
//
//   base: { trace: work.trace, platform: gap9 }
//   points:
//     - grid: { platform.cluster.clock: [240, 370] }
//
// All faults are InputErrors with file, line, key and the nearest valid name.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "platform_models/loader/platform_file.h"
#include "platform_models/loader/value.h"
#include "tools/app/study/sweep/key_domain.h"
#include "tools/app/study/sweep/sweep_inputs.h"
#include "tools/app/study/sweep/sweep_key.h"

namespace leviosim::tools {

/// Values by the names of keys.
using SweepRow = std::map<std::string, std::string>;

struct SweepAxis {
  SweepKey key;
  platform::Place place;
  Domain domain;
};

struct SweepMember {
  enum class Kind { grid, list, random, latin_hypercube };
  Kind kind = Kind::grid;
  platform::Place place;
  std::vector<SweepAxis> axes;  ///< in the order of the file; of a list, only their keys
  std::vector<SweepRow> rows;   ///< of a list
  std::size_t count = 0;        ///< of random points
  std::uint64_t seed = 1;       ///< of their draws
};

struct SweepGroup {
  platform::Place place;
  std::vector<SweepMember> members;
};

struct SweepPlan {
  std::string file;
  std::string text;
  SweepRow base;
  std::map<std::string, platform::Place> base_places;
  std::vector<SweepGroup> groups;
  std::vector<SweepKey> keys;    ///< that groups set, each once, in the order of the file
  bool skip_impossible = false;  ///< points that contradict themselves are left out
  platform::PlatformFile* reference = nullptr;  ///< the inputs'
};

/// @param inputs  opens what the plan names; outlives the plan
SweepPlan read_plan(const std::string& file, SweepInputs& inputs);
/// The same from its text.
SweepPlan parse_plan(const std::string& file, const std::string& text, SweepInputs& inputs);

}  // namespace leviosim::tools
