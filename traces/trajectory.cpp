#include "traces/trajectory.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <string_view>

#include "sim/error.h"
#include "traces/asl_reader.h"
#include "traces/atomic_file.h"
#include "traces/csv.h"

namespace leviosim::traces {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::size_t kDecimals = 9;
constexpr double kQuaternionTolerance = 1e-3;

/// Flips the sign so that the first component of (w, x, y, z) that is not zero is positive.
Eigen::Quaterniond canonical(const Eigen::Quaterniond& q) {
  for (const double component : {q.w(), q.x(), q.y(), q.z()}) {
    if (component > 0) return q;
    if (component < 0) return Eigen::Quaterniond(-q.coeffs());
  }
  return q;
}

void append_number(std::string& out, double value) {
  constexpr double kPrintsAsZero = 0.5e-9;
  if (std::abs(value) < kPrintsAsZero) value = 0;
  fmt::format_to(std::back_inserter(out), " {:.9f}", value);
}

bool all_digits(std::string_view text) {
  return text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// Digits to an integer; false if there is none or it does not fit.
bool parse_digits(std::string_view text, std::int64_t& value) {
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && stop == text.data() + text.size();
}

/// Seconds in plain decimal notation to nanoseconds, without rounding through a double. Digits
/// beyond the ninth are dropped.
bool parse_plain_seconds(std::string_view text, std::int64_t& ns) {
  const auto dot = text.find('.');
  const std::string_view whole = text.substr(0, dot);
  std::string decimals(dot == std::string_view::npos ? std::string_view() : text.substr(dot + 1));
  if (!all_digits(whole) || !all_digits(decimals)) return false;
  decimals.resize(kDecimals, '0');
  std::int64_t seconds = 0;
  std::int64_t fraction = 0;
  if (!parse_digits(whole, seconds) || !parse_digits(decimals, fraction)) return false;
  if (seconds > INT64_MAX / kNsPerSecond - 1) return false;
  ns = seconds * kNsPerSecond + fraction;
  return true;
}

std::int64_t parse_stamp(const CsvRow& row) {
  constexpr double kMostSeconds = 9e9;
  std::int64_t ns = 0;
  if (parse_plain_seconds(row.text(0), ns)) return ns;
  const double seconds = row.number(0);
  if (seconds < 0 || seconds > kMostSeconds)
    row.fail(0, "not a time stamp, which is seconds from 0 to 9e9");
  return std::llround(seconds * static_cast<double>(kNsPerSecond));
}

}  // namespace

std::string format_tum(const Trajectory& trajectory) {
  std::string out = "# timestamp tx ty tz qx qy qz qw\n";
  for (const StampedPose& pose : trajectory) {
    const Eigen::Vector3d p = pose.T_world_body.translation();
    const Eigen::Quaterniond q =
        canonical(Eigen::Quaterniond(pose.T_world_body.linear()).normalized());
    fmt::format_to(std::back_inserter(out), "{}.{:09d}", pose.t_ns / kNsPerSecond,
                   pose.t_ns % kNsPerSecond);
    for (const double value : {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()})
      append_number(out, value);
    out += '\n';
  }
  return out;
}

void write_tum(const std::filesystem::path& file, const Trajectory& trajectory) {
  write_file_atomically(file, format_tum(trajectory));
}

Trajectory read_tum(const std::filesystem::path& file) {
  CsvReader csv(file, Separator::blanks, {"timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw"});
  RisingStamps stamps;
  Trajectory trajectory;
  while (const CsvRow* row = csv.next()) {
    const std::int64_t t_ns = parse_stamp(*row);
    stamps.add(*row, t_ns);
    const Eigen::Quaterniond q(row->number(7), row->number(4), row->number(5), row->number(6));
    if (std::abs(q.norm() - 1) > kQuaternionTolerance)
      row->fail(fmt::format("the quaternion has norm {:.6f} instead of 1", q.norm()));
    const Eigen::Translation3d p(row->number(1), row->number(2), row->number(3));
    trajectory.push_back({t_ns, p * q.normalized()});
  }
  if (trajectory.empty()) throw InputError(fmt::format("{}: holds no pose", file.string()));
  return trajectory;
}

Trajectory read_euroc_trajectory(const std::filesystem::path& file) {
  return to_trajectory(read_ground_truth_csv(file));
}

Trajectory to_trajectory(const std::vector<GroundTruthPose>& ground_truth) {
  Trajectory trajectory;
  trajectory.reserve(ground_truth.size());
  for (const GroundTruthPose& pose : ground_truth)
    trajectory.push_back({pose.t_ns, pose.T_world_body});
  return trajectory;
}

}  // namespace leviosim::traces
