// Published figures to compare a run with, as data: tools/app/validation/published/paper.csv, which
// is part of the program. Each has a tolerance and says whether it is met. One that is not stays
// visible with its reason, and its error is guarded: a later change may not make it worse without a
// test that fails.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace leviosim::tools {

/// An error, or a bound of one: per cent of the reference, or a difference in its unit.
struct Deviation {
  double value = 0;
  bool relative = true;
};

struct Reference {
  std::string name;     ///< "compute.epnp_ransac.single"; of a quantity (validation.h)
  double value = 0;     ///< never 0 if the tolerance is relative
  bool limit = false;   ///< the value is an upper limit ("<50") and not an expectation
  std::string unit;     ///< of the quantity
  Deviation tolerance;  ///< largest error that the project aims at
  bool met = true;
  std::string reason;           ///< if not met: what is missing
  std::optional<double> guard;  ///< if not met: error that may not be exceeded, as the tolerance
  std::string source;
};

/// From a CSV text without quotes: comments (#), the header
/// name,value,unit,tolerance,guard,status,source, then a row each. Value: a number or "<number".
/// Tolerance and guard: "12 %" or a number in the unit. Status: "met", with an empty guard, or
/// "missed: REASON" with one above the tolerance.
/// @throws InputError with file and line
std::vector<Reference> parse_references(const std::string& file, std::string_view text);

/// Those of the LEVIO paper.
std::vector<Reference> paper_references();

/// Signed error of `value`. A limit that is kept has none.
double error_of(const Reference& reference, double value);

enum class Verdict {
  Met,        ///< within the tolerance, as the reference says
  Missed,     ///< outside, as the reference says, and no worse than its guard
  Worse,      ///< outside the tolerance, or the guard of what was missed before
  Improved,   ///< within the tolerance, though the reference says it is missed
  NotCovered  ///< the run shows no such quantity
};
std::string_view name_of(Verdict verdict);

Verdict judge(const Reference& reference, std::optional<double> value);
/// The same of an error. @param guard  of what is known to be missed; otherwise absent
Verdict judge(double error, double tolerance, std::optional<double> guard);

/// The file with statuses and guards brought up to date with what was measured; everything else,
/// comments included, stays as it is. Reasons are kept; a newly missed one gets `new_reason`.
/// @param values  by the order of the references in the text; nothing: the row stays
std::string updated_references(const std::string& file, std::string_view text,
                               const std::vector<std::optional<double>>& values,
                               const std::string& new_reason);

/// The text of paper.csv.
std::string_view paper_references_text();

}  // namespace leviosim::tools
