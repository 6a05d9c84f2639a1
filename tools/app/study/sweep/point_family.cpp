#include "tools/app/study/sweep/point_family.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/run/workload_overrides.h"

namespace leviosim::tools {
namespace {

using Kind = SweepKey::Kind;

// In place of a number.
constexpr double kUnread = std::numeric_limits<double>::quiet_NaN();
constexpr double kImpossible = std::numeric_limits<double>::infinity();

constexpr std::size_t kNoKey = static_cast<std::size_t>(-1);
constexpr const char* kWorkers = "platform.cluster.workers";

bool varies(const SweepKey& key) {
  return key.kind == Kind::chip || key.kind == Kind::workload || key.kind == Kind::seed ||
         key.kind == Kind::cores;
}

std::size_t index_of(const SweepPlan& plan, std::string_view name) {
  for (std::size_t k = 0; k < plan.keys.size(); ++k)
    if (plan.keys[k].name == name) return k;
  return kNoKey;
}

std::optional<int> cores_of_base(const SweepPlan& plan, const SweepRow& settings) {
  const auto it = settings.find("cores");
  if (index_of(plan, "cores") != kNoKey || it == settings.end()) return std::nullopt;
  return static_cast<int>(parse_whole("cores", it->second, 1, std::numeric_limits<int>::max()));
}

}  // namespace

std::vector<ValueId> PointFamily::identifier(const SweepPlan& plan,
                                             std::span<const ValueId> values) {
  std::vector<ValueId> id(values.begin(), values.end());
  for (std::size_t k = 0; k < id.size(); ++k)
    if (varies(plan.keys[k]) && id[k] != kUnset) id[k] = 0;
  return id;
}

PointFamily::PointFamily(const SweepPlan& plan, const ValuePool& pool,
                         std::span<const ValueId> values, const SweepRow& settings,
                         const ResolvedPoint& first)
    : plan_(plan),
      pool_(pool),
      trace_(first.trace),
      profile_name_(first.request.profile),
      size_(fmt::format("{}x{}", first.request.image_size.width, first.request.image_size.height)),
      seed_(first.request.seed),
      schema_(first.chip->schema()),
      chip_(schema_, first.chip->settings_with(first.overrides)),
      profile_(profile_of(first.request)),
      base_cores_(cores_of_base(plan, settings)),
      workers_(first.request.platform.config.cluster.workers),
      cores_key_(index_of(plan, "cores")),
      workers_key_(index_of(plan, kWorkers)),
      last_(plan.keys.size(), kUnread) {
  for (std::size_t k = 0; k < plan.keys.size(); ++k) slots_.push_back(slot_of(k));
  check(accepts(values), "a family accepts the point that it was made from");
  parts_ = parts_of(first, values);
  for (const Part& part : parts_)
    outline_ +=
        fmt::format("{}\x01{}\x01{}\x01", part.text, part.key ? part.key->name : "", part.rest);
}

PointFamily::Slot PointFamily::slot_of(std::size_t k) const {
  const SweepKey& key = plan_.keys[k];
  Slot slot;
  if (key.kind == Kind::chip) {
    slot.field = schema_.find(key.path);
    const auto& setting = chip_.settings()[slot.field];
    slot.given = setting.has_value();
    if (slot.given) slot.otherwise = setting->base;
    if (key.is_number(schema_)) slot.unit = chip_number(key, 0, *plan_.reference);
  } else if (key.kind == Kind::workload) {
    slot.given = trace_ == nullptr;
    slot.otherwise = key.parameter->get(profile_);
  } else if (key.kind == Kind::seed) {
    slot.given = trace_ == nullptr;
    slot.otherwise = seed_;
  }
  return slot;
}

/// The number that a value of a key is, or kImpossible.
double PointFamily::read(std::size_t k, ValueId id) const {
  const SweepKey& key = plan_.keys[k];
  const std::string& text = pool_.text(k, id);
  if (key.kind == Kind::chip) return chip_.value_of(slots_[k].field, text).value_or(kImpossible);
  try {
    if (key.kind == Kind::workload) {
      vio::Profile profile = profile_;  // which holds single precision
      key.parameter->set(profile, parse_workload_value(key.name, *key.parameter, text));
      return key.parameter->get(profile);
    }
    const std::int64_t most = key.kind == Kind::seed ? std::numeric_limits<std::uint32_t>::max()
                                                     : std::numeric_limits<int>::max();
    return static_cast<double>(parse_whole(key.name, text, key.kind == Kind::seed ? 0 : 1, most));
  } catch (const InputError&) {
    return kImpossible;
  }
}

double PointFamily::number(std::size_t k, std::span<const ValueId> values) const {
  if (!varies(plan_.keys[k])) return 0;
  if (is_set(k, values)) return slots_[k].numbers[values[k]];
  return k == cores_key_ ? cores(values) : slots_[k].otherwise;
}

int PointFamily::cores(std::span<const ValueId> values) const {
  if (cores_key_ != kNoKey && is_set(cores_key_, values))
    return static_cast<int>(slots_[cores_key_].numbers[values[cores_key_]]);
  if (base_cores_) return *base_cores_;
  return workers_key_ == kNoKey ? workers_ : static_cast<int>(number(workers_key_, values));
}

void PointFamily::put_numbers(std::span<const ValueId> values, std::span<double> numbers) const {
  for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = number(k, values);
}

bool PointFamily::accepts(std::span<const ValueId> values) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!varies(plan_.keys[k]) || !is_set(k, values)) continue;
    std::vector<double>& numbers = slots_[k].numbers;
    if (values[k] >= numbers.size()) numbers.resize(pool_.size(k), kUnread);
    double& number = numbers[values[k]];
    if (std::isnan(number)) number = read(k, values[k]);
    if (number == kImpossible) return false;
  }
  bool changed = false;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double now = number(k, values);
    if (now == last_[k]) continue;
    change(k, values, now);
    last_[k] = now;
    changed = true;
  }
  if (changed) verdict_ = is_possible(values);
  return verdict_;
}

void PointFamily::change(std::size_t k, std::span<const ValueId> values, double number) {
  if (!is_set(k, values)) return;  // is what it was
  const SweepKey& key = plan_.keys[k];
  if (key.kind == Kind::chip) chip_.set(slots_[k].field, number, pool_.text(k, values[k]));
  if (key.kind == Kind::workload) key.parameter->set(profile_, number);
}

bool PointFamily::is_possible(std::span<const ValueId> values) const {
  const sim::ClusterConfig& cluster = chip_.config().cluster;
  const int team = cores(values);
  if (team > cluster.max_workers) return false;
  if (trace_ != nullptr && trace_->info().cores != team) return false;
  try {
    check_together(profile_);
  } catch (const InputError&) {
    return false;
  }
  return chip_.is_possible();
}

std::string PointFamily::line(const SweepKey& key, double number) {
  switch (key.kind) {
    case Kind::chip:
      return fmt::format("{} {}", key.path, platform::number_text(number));
    case Kind::workload:
      return fmt::format("{} {}", key.name, value_text(*key.parameter, number));
    default:
      return fmt::format("{} {}", key.name, static_cast<std::int64_t>(number));
  }
}

std::vector<PointFamily::Part> PointFamily::parts_of(const ResolvedPoint& first,
                                                     std::span<const ValueId> values) {
  std::vector<Part> parts(1);
  for (const IdentityLine& of : first.identity) {
    const std::size_t k = of.key.empty() ? kNoKey : index_of(plan_, of.key);
    const bool is_cores = of.key == "cores";
    if (!is_cores && (k == kNoKey || !varies(plan_.keys[k]))) {
      parts.back().text += of.text;
      continue;
    }
    Part& part = parts.back();
    part.key = is_cores ? SweepKey{Kind::cores, "cores"} : plan_.keys[k];
    part.index = k;
    const std::string begin = line(*part.key, is_cores ? cores(values) : number(k, values));
    check(of.text.starts_with(begin), "the line of a key begins with its number");
    part.rest = of.text.substr(begin.size());
    parts.emplace_back();
  }
  return parts;
}

std::string PointFamily::identity(std::span<const ValueId> values) const {
  std::string text;
  for (const Part& part : parts_) {
    text += part.text;
    if (!part.key) continue;
    const bool is_cores = part.key->kind == Kind::cores;
    text += line(*part.key, is_cores ? cores(values) : number(part.index, values)) + part.rest;
  }
  return text;
}

PointParameter PointFamily::parameter(std::size_t k, std::span<const ValueId> values) const {
  const SweepKey& key = plan_.keys[k];
  const Slot& slot = slots_[k];
  const std::string set = is_set(k, values) ? pool_.text(k, values[k]) : std::string();
  switch (key.kind) {
    case Kind::chip: {
      if (set.empty() && !slot.given) return {key.name, {}, {}, {}};
      const double base = number(k, values);
      const platform::Field& field = schema_.fields()[slot.field];
      if (field.is_choice())
        return {key.name, field.choices[static_cast<std::size_t>(base)], {}, {}};
      const SweepNumber shown{base / slot.unit.factor, slot.unit.factor, slot.unit.unit};
      return {key.name, shown.text(), shown.value, shown.unit};
    }
    case Kind::workload: {
      if (trace_ != nullptr) return {key.name, set, {}, {}};
      const double value = number(k, values);
      return {key.name, value_text(*key.parameter, value), value, std::string(key.parameter->unit)};
    }
    case Kind::seed:
    case Kind::cores: {
      if (key.kind == Kind::seed && set.empty() && !slot.given) return {key.name, {}, {}, {}};
      const std::string text =
          set.empty() ? fmt::format("{}", static_cast<std::int64_t>(number(k, values))) : set;
      return {key.name, text, platform::parse_number(text), {}};
    }
    case Kind::profile:
      return {key.name, set.empty() && trace_ == nullptr ? profile_name_ : set, {}, {}};
    case Kind::size:
      return {key.name, set.empty() && trace_ == nullptr ? size_ : set, {}, {}};
    default:
      return {key.name, set, {}, {}};
  }
}

}  // namespace leviosim::tools
