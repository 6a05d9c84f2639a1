#include "tools/app/study/sweep/points.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <limits>
#include <numeric>
#include <unordered_set>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/run/replay.h"
#include "tools/app/run/run_options.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/workload.h"
#include "tools/app/run/workload_options.h"
#include "tools/app/study/sweep/key_domain.h"
#include "tools/app/study/sweep/plan.h"
#include "tools/app/study/sweep/sweep_inputs.h"
#include "tools/app/study/sweep/sweep_key.h"
#include "traces/datasets/image_preparation.h"
#include "traces/datasets/rng.h"

namespace leviosim::tools {
namespace {

const std::string kPlatformPrefix = "platform.";

class Resolver {
 public:
  Resolver(const SweepPlan& plan, const SweepRow& settings, SweepInputs& inputs,
           const std::string& where)
      : plan_(plan), settings_(settings), inputs_(inputs), place_{where} {}

  ResolvedPoint resolve() {
    if (has("trace") == has("data"))
      place_.fail(has("trace") ? "has a trace and data; expected one of them"
                               : "has neither trace nor data; expected one of them");
    try {
      if (has("trace"))
        take_recording();
      else
        take_data();
    } catch (const InputError& error) {
      const std::string what = error.what();
      if (what.starts_with(place_.where)) throw;
      place_.fail(what);
    }
    point_.identity = identity_of(point_, point_.chip->schema());
    return std::move(point_);
  }

 private:
  bool has(const std::string& name) const { return settings_.count(name) > 0; }
  std::string text(const std::string& name, const std::string& otherwise = {}) const {
    const auto it = settings_.find(name);
    return it == settings_.end() ? otherwise : it->second;
  }
  std::vector<std::string> with_prefix(std::string_view prefix, bool keep) const {
    std::vector<std::string> found;
    for (const auto& [name, value] : settings_)
      if (name.starts_with(prefix))
        found.push_back(fmt::format("{}={}", keep ? name : name.substr(prefix.size()), value));
    return found;
  }

  void take_chip(platform::PlatformFile& file) {
    point_.chip = &file;
    point_.overrides = with_prefix(kPlatformPrefix, false);
    point_.request.platform = file.resolve(point_.overrides);
    const sim::ClusterConfig& cluster = point_.request.platform.config.cluster;
    point_.request.cores =
        has("cores") ? static_cast<int>(parse_whole("cores", text("cores"), 1, cluster.workers,
                                                    ", the chip's cluster.workers"))
                     : cluster.workers;
  }

  void take_recording() {
    for (const auto& [name, value] : settings_)
      if (find_key(name, plan_.reference->schema(), place_).belongs_to_recording())
        place_.fail(
            fmt::format("{}: recorded work is that of a run as it was; expected data in place of "
                        "the trace",
                        name));
    SweepInputs::Trace& trace = inputs_.trace(text("trace"), place_);
    point_.trace = trace.work.get();
    point_.work = fmt::format("trace {}", trace.sha256);
    take_chip(has("platform") ? inputs_.platform(text("platform"), place_) : trace.platform);
    check_cores(*trace.work, point_.request);
  }

  void take_data() {
    if (!has("platform")) place_.fail("has no platform; expected one (leviosim platforms)");
    RunRequest& request = point_.request;
    const SweepInputs::Data& data = inputs_.data(text("data"), text("frames"), place_);
    request.data = data.folder;
    request.pictures = inputs_.pictures();
    if (has("frames")) request.frames = traces::parse_frame_range(text("frames"));
    request.image_size = parse_size(text("size", "160x120"));
    traces::make_decimation(data.camera, request.image_size);
    request.profile = text("profile", request.profile);
    request.seed = static_cast<std::uint32_t>(
        parse_whole("seed", text("seed", "1"), 0, std::numeric_limits<std::uint32_t>::max()));
    request.workload = parse_workload_overrides(with_prefix(vio::kParameterPrefix, true));
    check_profile(request);
    point_.work = data.work;
    take_chip(inputs_.platform(text("platform"), place_));
  }

  const SweepPlan& plan_;
  const SweepRow& settings_;
  SweepInputs& inputs_;
  platform::Place place_;
  ResolvedPoint point_;
};

/// What a key is at a point, set there or not.
class ParameterReader {
 public:
  ParameterReader(const SweepPlan& plan, const ResolvedPoint& point, const SweepRow& settings)
      : plan_(plan),
        point_(point),
        settings_(settings),
        chip_(point.chip->settings_with(point.overrides)) {}

  PointParameter read(const SweepKey& key) const {
    const auto it = settings_.find(key.name);
    const std::string set = it == settings_.end() ? std::string() : it->second;
    const RunRequest& request = point_.request;
    if (key.kind == SweepKey::Kind::chip) return chip_parameter(key);
    if (key.kind == SweepKey::Kind::cores) return whole(key, request.cores);
    if (point_.trace != nullptr) return {key.name, set};
    switch (key.kind) {
      case SweepKey::Kind::workload: {
        const double value = value_of(request, *key.parameter);
        return {key.name, value_text(*key.parameter, value), value,
                std::string(key.parameter->unit)};
      }
      case SweepKey::Kind::seed:
        return whole(key, request.seed);
      case SweepKey::Kind::profile:
        return {key.name, request.profile};
      case SweepKey::Kind::size:
        return {key.name,
                fmt::format("{}x{}", request.image_size.width, request.image_size.height)};
      default:
        return {key.name, set};
    }
  }

 private:
  static PointParameter whole(const SweepKey& key, std::int64_t value) {
    return {key.name, fmt::format("{}", value), static_cast<double>(value)};
  }
  PointParameter chip_parameter(const SweepKey& key) const {
    const platform::Schema& schema = point_.chip->schema();
    const std::size_t field = schema.find(key.path);
    const std::optional<platform::Setting>& setting = chip_[field];
    if (!setting) return {key.name, {}};
    if (schema.fields()[field].is_choice()) return {key.name, setting->parameter.value};
    const SweepNumber number = chip_number(key, setting->base, *plan_.reference);
    return {key.name, number.text(), number.value, number.unit};
  }

  const SweepPlan& plan_;
  const ResolvedPoint& point_;
  const SweepRow& settings_;
  platform::Settings chip_;
};

std::string text_of(const SweepRow& row) {
  std::vector<std::string> parts;
  for (const auto& [name, value] : row)
    parts.push_back(fmt::format("{}={}", name, without_count_unit(value)));
  return fmt::format("{}", fmt::join(parts, " "));
}

using MemberKind = SweepMember::Kind;

/// @throws InputError at `place` for too many
std::size_t multiplied(std::size_t a, std::size_t b, const platform::Place& place) {
  if (b != 0 && a > kMostPoints / b)
    place.fail(fmt::format("gives more than {} points; expected fewer values", kMostPoints));
  return a * b;
}

std::size_t count_of(const SweepMember& member) {
  if (member.kind == MemberKind::list) return member.rows.size();
  if (member.kind != MemberKind::grid) return member.count;
  std::size_t rows = 1;
  for (const SweepAxis& axis : member.axes)
    rows = multiplied(rows, axis.domain.values.size(), member.place);
  return rows;
}

std::vector<SweepRow> drawn_rows(const SweepMember& member) {
  std::vector<SweepRow> rows(member.count);
  for (std::size_t d = 0; d < member.axes.size(); ++d) {
    const SweepAxis& axis = member.axes[d];
    const std::vector<double> draws = member.kind == MemberKind::random
                                          ? random_draws(member.count, d, member.seed)
                                          : latin_draws(member.count, d, member.seed);
    throw_if_interrupted();
    for (std::size_t i = 0; i < member.count; ++i)
      rows[i][axis.key.name] = value_at(axis.domain, draws[i]);
  }
  return rows;
}

/// Every one of `rows` with every one of `others`, which vary faster.
std::vector<SweepRow> product(const std::vector<SweepRow>& rows,
                              const std::vector<SweepRow>& others) {
  std::vector<SweepRow> all;
  for (const SweepRow& row : rows) {
    throw_if_interrupted();
    for (const SweepRow& other : others) all.emplace_back(row).insert(other.begin(), other.end());
  }
  return all;
}

std::vector<SweepRow> rows_of(const SweepMember& member) {
  if (member.kind == MemberKind::list) return member.rows;
  if (member.kind != MemberKind::grid) return drawn_rows(member);
  std::vector<SweepRow> rows(1);
  for (const SweepAxis& axis : member.axes) {
    std::vector<SweepRow> values;
    for (const std::string& value : axis.domain.values) values.push_back({{axis.key.name, value}});
    rows = product(rows, values);
  }
  return rows;
}

}  // namespace

ResolvedPoint resolve(const SweepPlan& plan, const SweepRow& settings, SweepInputs& inputs,
                      const std::string& where) {
  return Resolver(plan, settings, inputs, where).resolve();
}

std::string SweepPoint::settings_text() const {
  std::vector<std::string> parts;
  for (const PointParameter& p : parameters)
    parts.push_back(fmt::format("{}={}", p.name, without_count_unit(p.text)));
  return fmt::format("{}", fmt::join(parts, " "));
}

Expansion expand(const SweepPlan& plan, SweepInputs& inputs) {
  Expansion all;
  std::unordered_set<std::string> seen;  // keys
  const auto add = [&](const SweepGroup& group, SweepRow row) {
    const std::string where = fmt::format("{}: point {}", group.place.where, text_of(row));
    row.insert(plan.base.begin(), plan.base.end());
    try {
      const ResolvedPoint point = resolve(plan, row, inputs, where);
      std::string key = point_key(kSweepFigures, point.identity);
      if (!seen.insert(key).second) return;
      SweepPoint& added = all.points.emplace_back();
      added.number = static_cast<int>(all.points.size());
      const ParameterReader parameters(plan, point, row);
      for (const SweepKey& k : plan.keys) added.parameters.push_back(parameters.read(k));
      added.settings = std::move(row);
      added.key = std::move(key);
    } catch (const InputError& error) {
      if (!plan.skip_impossible) throw;
      if (all.impossible++ == 0) all.first_impossible = error.what();
    }
  };
  for (const SweepGroup& group : plan.groups) {
    std::vector<SweepRow> rows = rows_of(group);
    all.asked += rows.size();
    if (all.asked > kMostPoints)
      group.place.fail(fmt::format("gives more than {} points in all", kMostPoints));
    for (SweepRow& row : rows) {
      throw_if_interrupted();
      add(group, std::move(row));
    }
  }
  if (all.points.empty())
    throw InputError(
        fmt::format("{}: no point of the plan is possible: {}", plan.file, all.first_impossible));
  return all;
}

std::vector<double> random_draws(std::size_t count, std::size_t dimension, std::uint64_t seed) {
  std::vector<double> draws(count);
  for (std::size_t i = 0; i < count; ++i)
    draws[i] = traces::Rng(traces::derive_seed(traces::derive_seed(seed, i), dimension)).uniform();
  return draws;
}

std::vector<double> latin_draws(std::size_t count, std::size_t dimension, std::uint64_t seed) {
  constexpr double kInside = 1 - 1e-9;  // rounding must not lift a point into the next stratum
  std::vector<double> draws(count);
  std::vector<std::uint32_t> strata(count);
  traces::Rng rng(traces::derive_seed(seed, dimension));
  std::iota(strata.begin(), strata.end(), 0u);
  for (std::size_t i = count; i > 1; --i)  // Fisher and Yates
    std::swap(strata[i - 1], strata[static_cast<std::size_t>(rng.below(static_cast<int>(i)))]);
  for (std::size_t i = 0; i < count; ++i)
    draws[i] =
        (static_cast<double>(strata[i]) + kInside * rng.uniform()) / static_cast<double>(count);
  return draws;
}

std::vector<SweepRow> rows_of(const SweepGroup& group) {
  std::size_t count = 1;  // refused before any is made
  for (const SweepMember& member : group.members)
    count = multiplied(count, count_of(member), group.place);
  std::vector<SweepRow> rows(1);
  for (const SweepMember& member : group.members) rows = product(rows, rows_of(member));
  return rows;
}

}  // namespace leviosim::tools
