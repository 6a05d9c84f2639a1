#include "tools/app/study/explore/dimensions.h"

#include <fmt/core.h>

#include <algorithm>

#include "sim/base/check.h"
#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "tools/app/run/workload_overrides.h"
#include "traces/datasets/rng.h"

namespace leviosim::tools {
namespace {

using vio::Parameter;

/// To three digits, so that a point can be typed again exactly.
double to_three_digits(double value) {
  double rounded = value;
  check(base::parse_number(fmt::format("{:.3g}", value), rounded), "a formatted number");
  return rounded;
}

double draw(const Dimension& dimension, std::uint64_t seed) {
  traces::Rng rng(seed);
  const auto [parameter, low, high] = dimension;
  if (parameter->kind != Parameter::Kind::number)
    return low + rng.below(static_cast<int>(high - low) + 1);
  return std::clamp(to_three_digits(rng.log_uniform(low, high)), low, high);
}

/// From a quarter to four times the profile's.
Dimension around(const char* name, const vio::Profile& profile) {
  const Parameter* const parameter = vio::find_parameter(name);
  check(parameter != nullptr, name);
  const double value = to_three_digits(parameter->get(profile));
  return {parameter, std::max(parameter->low, value / 4), std::min(parameter->high, value * 4)};
}

}  // namespace

std::vector<Dimension> paper_dimensions() {
  const vio::Profile levio = vio::profile_named("levio", 1);
  return {{vio::find_parameter("workload.window"), 4, 16},
          around("workload.keyframe_parallax", levio),
          around("workload.reprojection_noise", levio),
          around("workload.imu_noise.gyro", levio),
          around("workload.imu_noise.accel", levio),
          {vio::find_parameter("workload.gravity_updates"), 0, 1}};
}

Dimension parse_dimension(const std::string& text) {
  const std::string where = "--vary " + text;
  const std::size_t equals = text.find('=');
  const Parameter& parameter = workload_parameter(where, text.substr(0, equals));
  if (parameter.is_of_another())
    throw InputError(where +
                     ": is no parameter of the odometry; expected one of leviosim workload "
                     "--profile levio");
  if (parameter.kind == Parameter::Kind::toggle) {
    if (equals != std::string::npos)
      throw InputError(fmt::format("{}: is off or on; expected no range", where));
    return {&parameter, 0, 1};
  }
  const std::size_t colon = text.find(':');
  if (equals == std::string::npos || colon == std::string::npos || colon < equals)
    throw InputError(fmt::format("{}: expected NAME=LOW:HIGH", where));
  const Dimension dimension{
      &parameter,
      parse_workload_value(where, parameter, text.substr(equals + 1, colon - equals - 1)),
      parse_workload_value(where, parameter, text.substr(colon + 1))};
  if (!(dimension.low < dimension.high))
    throw InputError(fmt::format("{}: expected the lower value first", where));
  return dimension;
}

std::vector<std::vector<vio::Assignment>> sample_points(const std::vector<Dimension>& dimensions,
                                                        std::size_t count, std::uint64_t seed) {
  std::vector<std::vector<vio::Assignment>> points(count);
  for (std::size_t i = 1; i < count; ++i)
    for (std::size_t d = 0; d < dimensions.size(); ++d)
      points[i].push_back(
          {dimensions[d].parameter,
           draw(dimensions[d], traces::derive_seed(traces::derive_seed(seed, i), d))});
  return points;
}

}  // namespace leviosim::tools
