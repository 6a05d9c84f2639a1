// The text that `leviosim validate` prints.
#pragma once

#include <string>
#include <vector>

#include "tools/app/validation/validation.h"

namespace leviosim::tools {

/// Stages: cycles on one core and on N and the speed-up, each beside the paper's with its error.
std::string compute_table(const std::vector<Comparison>& comparisons, int cores);

/// All other references, in groups by the first part of their names.
std::string reference_table(const Validation& validation);

/// Inputs, cycles per unit of work, and how a comparison of cycles must be read.
std::string input_table(const Validation& validation);
std::string normalised_table(const Validation& validation, int cores);

/// The paper's table of cycles beside the bands of the run; empty if it has none.
std::string band_table(const std::vector<BandedStage>& bands, int cores);

/// All of them, as parts of a screen.
std::vector<std::string> validation_report(const Validation& validation, int cores);

/// Whether a figure is outside its tolerance, or the guard of what was missed before; and in a
/// sentence how many are not.
bool is_worse(const Validation& validation);
std::string validation_conclusion(const Validation& validation);

}  // namespace leviosim::tools
