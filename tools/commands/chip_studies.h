// Studies of chips: what a workload takes on them, beside published systems too. They are actions
// of `leviosim platforms`.
#pragma once

#include <string>
#include <vector>

#include "tools/app/study/study.h"

namespace leviosim::tools {

struct ChipStudyOptions {
  std::vector<std::string> names;  ///< chips: names or files; empty: all
  StudyOptions run;
};

/// Frame rate, energy and memory on each chip, on all of its workers and on one.
/// @throws InputError, LimitNotMet if a chip that was named is too small
void time_feasibility(const ChipStudyOptions& options);
/// The stages of a frame on chips that can run the workload. @throws InputError
void time_stages(const ChipStudyOptions& options);
/// Published systems beside what is predicted for them; each has its own workload and chip.
/// @throws InputError
void predict_published_systems(const ChipStudyOptions& options);

}  // namespace leviosim::tools
