// A trajectory and its errors as one picture: views from top (x, y) and side (x, z) at the same
// scale, with the aligned estimate coloured by its error over the truth in grey; translation,
// tilt and heading error over time. World z is up.
#pragma once

#include <string>

#include "traces/trajectories/evaluation.h"
#include "traces/trajectories/trajectory_file.h"

namespace leviosim::tools {

/// The text of an SVG file; the same inputs give the same bytes. `evaluation` is that of the pair.
std::string trajectory_plot(const traces::TrajectoryPair& pair,
                            const traces::Evaluation& evaluation);

}  // namespace leviosim::tools
