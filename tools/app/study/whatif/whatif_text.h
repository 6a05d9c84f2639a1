// What if, as text for people: a row a variant with what it gains and why, and the answer in a
// sentence. Left out: files and pages (whatif.h).
#pragma once

#include <string>
#include <vector>

#include "tools/app/study/whatif/whatif.h"

namespace leviosim::tools {

/// Why a variant takes another time: "waiting for code -11.2 ms, most in EPnP RANSAC".
std::string reason_of(const VariantResult& base, const VariantResult& variant);

/// The fastest variant, or that none can run, in a sentence.
std::string whatif_conclusion(const std::vector<VariantResult>& results);

/// A row a variant, in their order, with its reason below.
std::string whatif_table(const std::vector<VariantResult>& results);

/// What to buy, in a sentence: the fastest, what gains most per area, and what gains nothing.
std::string advice_conclusion(const std::vector<VariantResult>& results);

/// A row for each gain, the fastest first; what gains little or nothing is folded into lines.
std::string advice_text(const std::vector<VariantResult>& results);

}  // namespace leviosim::tools
