#include "tools/app/study/ablate/dimensions.h"

#include <fmt/core.h>

#include <algorithm>

#include "sim/base/check.h"
#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "tools/app/run/workload.h"
#include "tools/app/run/workload_options.h"
#include "tools/app/study/sweep/key_domain.h"
#include "tools/app/study/sweep/points.h"

namespace leviosim::tools {
namespace {

constexpr const char* kPaper = "paper";

RunRequest request_of(const std::string& profile, const std::vector<vio::Assignment>& set) {
  RunRequest request;
  request.profile = profile;
  request.workload = set;
  return request;
}

/// From a quarter to four times the profile's, which has three digits.
Dimension around(const char* name, const RunRequest& profile) {
  const vio::Parameter* const parameter = vio::find_parameter(name);
  check(parameter != nullptr, name);
  double value = 0;
  check(base::parse_number(fmt::format("{:.3g}", value_of(profile, *parameter)), value), name);
  return {parameter, std::max(parameter->low, value / 4), std::min(parameter->high, value * 4)};
}

/// "workload.window=4:12"; toggles take no range: "workload.gravity_updates".
/// @throws InputError for unknown parameters and ranges outside of what they can be
Dimension parse_dimension(const std::string& text) {
  const std::string where = "--vary " + text;
  const std::size_t equals = text.find('=');
  const vio::Parameter& parameter = workload_parameter(where, text.substr(0, equals));
  if (parameter.is_of_another())
    throw InputError(where +
                     ": is no parameter of the odometry; expected one of leviosim workload "
                     "--profile levio");
  if (parameter.kind == vio::Parameter::Kind::toggle) {
    if (equals != std::string::npos)
      throw InputError(fmt::format("{}: is off or on; expected no range", where));
    return {&parameter, 0, 1};
  }
  const std::size_t colon = text.find(':');
  if (equals == std::string::npos || colon == std::string::npos || colon < equals)
    throw InputError(fmt::format("{}: expected NAME=LOW:HIGH, or {}", where, kPaper));
  const Dimension dimension{
      &parameter,
      parse_workload_value(where, parameter, text.substr(equals + 1, colon - equals - 1)),
      parse_workload_value(where, parameter, text.substr(colon + 1))};
  if (!(dimension.low < dimension.high))
    throw InputError(fmt::format("{}: expected the lower value first", where));
  return dimension;
}

Domain domain_of(const Dimension& d) {
  using Kind = vio::Parameter::Kind;
  if (d.parameter->kind == Kind::toggle) return {{"off", "on"}, {}};
  const bool is_whole = d.parameter->kind == Kind::whole;
  return {{}, Span{d.low, d.high, !is_whole, is_whole, 1, {}}};
}

}  // namespace

std::vector<vio::Assignment> effective(const std::vector<vio::Assignment>& point,
                                       const std::string& profile) {
  const bool use_imu = vio::uses_imu(profile);
  std::vector<vio::Assignment> set;
  for (const vio::Assignment& a : point)
    if (use_imu || !a.parameter->needs_imu) set.push_back(a);
  return set;
}

std::vector<Dimension> paper_dimensions() {
  const RunRequest levio = request_of("levio", {});
  return {{vio::find_parameter("workload.window"), 4, 16},
          around("workload.keyframe_parallax", levio),
          around("workload.reprojection_noise", levio),
          around("workload.imu_noise.gyro", levio),
          around("workload.imu_noise.accel", levio),
          {vio::find_parameter("workload.gravity_updates"), 0, 1}};
}

DrawnPoints sample_points(const std::vector<Dimension>& dimensions, std::size_t count,
                          std::uint64_t seed) {
  DrawnPoints points(count);
  for (std::size_t d = 0; d < dimensions.size(); ++d) {
    const vio::Parameter& parameter = *dimensions[d].parameter;
    const Domain domain = domain_of(dimensions[d]);
    const std::vector<double> draws = random_draws(count, d, seed);
    for (std::size_t i = 1; i < count; ++i)
      points[i].push_back(
          {&parameter, parse_workload_value("--vary", parameter, value_at(domain, draws[i]))});
  }
  return points;
}

std::vector<Dimension> parse_dimensions(const std::vector<std::string>& words) {
  std::vector<Dimension> dimensions;
  for (const std::string& text : words) {
    if (text != kPaper) {
      dimensions.push_back(parse_dimension(text));
      continue;
    }
    const std::vector<Dimension> paper = paper_dimensions();
    dimensions.insert(dimensions.end(), paper.begin(), paper.end());
  }
  for (std::size_t i = 0; i < dimensions.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (dimensions[k].parameter == dimensions[i].parameter)
        throw InputError(fmt::format("--vary {}: is given twice", dimensions[i].parameter->name));
  return dimensions;
}

std::string value_in(const Dimension& dimension, const std::string& profile,
                     const std::vector<vio::Assignment>& set) {
  return dimension.parameter->needs_imu && !vio::uses_imu(profile)
             ? std::string()
             : vio::value_text(*dimension.parameter,
                               value_of(request_of(profile, set), *dimension.parameter));
}

}  // namespace leviosim::tools
