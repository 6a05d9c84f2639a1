#include "tools/app/study/sweep/points.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "tools/app/study/point.h"

namespace leviosim::tools {

SweepPoints::SweepPoints(const SweepPlan& plan)
    : plan_(&plan), pool_(std::make_unique<ValuePool>(plan.keys.size())) {
  for (std::size_t k = 0; k < plan.keys.size(); ++k) {
    const auto set = plan.base.find(plan.keys[k].name);
    base_.push_back(set == plan.base.end() ? kUnset : pool_->add(k, set->second));
  }
}

void SweepPoints::put_values(std::size_t row, std::span<ValueId> values) const {
  std::copy(base_.begin(), base_.end(), values.begin());
  const auto after = std::upper_bound(first_rows_.begin(), first_rows_.end(), row);
  const auto group = static_cast<std::size_t>(after - first_rows_.begin()) - 1;
  groups_[group].put(row - first_rows_[group], values);
}

std::vector<ValueId> SweepPoints::values_of(std::size_t row) const {
  std::vector<ValueId> values(base_.size());
  put_values(row, values);
  return values;
}

const PointFamily& SweepPoints::family_of(std::span<const ValueId> values) const {
  return *families_.at(PointFamily::identifier(*plan_, values));
}

SweepRow SweepPoints::settings_of(std::span<const ValueId> values) const {
  SweepRow settings = plan_->base;
  for (std::size_t k = 0; k < values.size(); ++k)
    if (values[k] != kUnset) settings[plan_->keys[k].name] = pool_->text(k, values[k]);
  return settings;
}

SweepRow SweepPoints::settings(std::size_t i) const { return settings_of(values_of(rows_[i])); }

std::string SweepPoints::key(std::size_t i) const {
  const std::vector<ValueId> values = values_of(rows_[i]);
  return point_key(kSweepFigures, family_of(values).identity(values));
}

SweepPoint SweepPoints::operator[](std::size_t i) const {
  const std::vector<ValueId> values = values_of(rows_[i]);
  const PointFamily& family = family_of(values);
  SweepPoint point{static_cast<int>(i) + 1, settings_of(values), {}, {}};
  for (std::size_t k = 0; k < values.size(); ++k)
    point.parameters.push_back(family.parameter(k, values));
  point.key = point_key(kSweepFigures, family.identity(values));
  return point;
}

std::string SweepPoints::settings_text(std::size_t i) const {
  const std::vector<ValueId> values = values_of(rows_[i]);
  const PointFamily& family = family_of(values);
  std::string text;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const PointParameter p = family.parameter(k, values);
    text += fmt::format("{}{}={}", k == 0 ? "" : " ", p.name, p.text);
  }
  return text;
}

namespace {

/// Of an outline and numbers: all bits count (the finaliser of MurmurHash3).
std::uint32_t hash_of(std::size_t outline, std::span<const double> numbers) {
  std::uint64_t hash = outline;
  for (const double number : numbers) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(number)) * 0xFF51AFD7ED558CCDu;
    hash = (hash ^ (hash >> 33)) * 0xC4CEB9FE1A85EC53u;
    hash ^= hash >> 33;
  }
  return static_cast<std::uint32_t>(hash ^ (hash >> 32));
}

std::string text_of(const SweepRow& row) {
  std::vector<std::string> parts;
  for (const auto& [name, value] : row) parts.push_back(fmt::format("{}={}", name, value));
  return fmt::format("{}", fmt::join(parts, " "));
}

}  // namespace

/// The rows of different points, told apart by a hash of what they are.
class SeenRows {
 public:
  /// Whether the row is new. @param is_same  whether a row that was there is the same point
  template <class IsSame>
  bool add(std::uint32_t hash, std::uint32_t row, const IsSame& is_same) {
    if (2 * (count_ + 1) > slots_.size()) grow();
    std::size_t at = hash & (slots_.size() - 1);
    for (; slots_[at].row != kFree; at = (at + 1) & (slots_.size() - 1))
      if (slots_[at].hash == hash && is_same(slots_[at].row)) return false;
    slots_[at] = {hash, row};
    ++count_;
    return true;
  }

 private:
  static constexpr std::uint32_t kFree = UINT32_MAX;
  struct Slot {
    std::uint32_t hash = 0;
    std::uint32_t row = kFree;
  };
  void grow() {
    std::vector<Slot> before(std::max<std::size_t>(16, 2 * slots_.size()));
    before.swap(slots_);
    for (const Slot& slot : before) {
      if (slot.row == kFree) continue;
      std::size_t at = slot.hash & (slots_.size() - 1);
      while (slots_[at].row != kFree) at = (at + 1) & (slots_.size() - 1);
      slots_[at] = slot;
    }
  }
  std::vector<Slot> slots_;
  std::size_t count_ = 0;
};

class Expander {
 public:
  Expander(const SweepPlan& plan, SweepInputs& inputs)
      : plan_(plan), inputs_(inputs), expansion_{SweepPoints(plan)}, points_(expansion_.points) {}

  Expansion expand() {
    for (const SweepGroup& group : plan_.groups) {
      points_.groups_.emplace_back(plan_, group, *points_.pool_);
      points_.first_rows_.push_back(expansion_.asked);
      const std::size_t rows = points_.groups_.back().size();
      if (expansion_.asked + rows > kMostPoints)
        group.place.fail(fmt::format("gives more than {} points in all", kMostPoints));
      for (std::size_t i = 0; i < rows; ++i) add(group, expansion_.asked++);
    }
    if (points_.size() == 0)
      throw InputError(fmt::format("{}: no point of the plan is possible: {}", plan_.file,
                                   expansion_.first_impossible));
    return std::move(expansion_);
  }

 private:
  struct Known {
    PointFamily* family = nullptr;
    std::size_t outline = 0;  ///< equal for equal outlines
  };

  void add(const SweepGroup& group, std::size_t row) {
    constexpr std::size_t kRowsPerPoll = 64;
    if (row % kRowsPerPoll == 0) throw_if_interrupted();
    points_.put_values(row, values_);
    Known* known = known_of(values_);
    if (known == nullptr || !known->family->accepts(values_)) {
      if (known != nullptr && expansion_.impossible > 0) {
        ++expansion_.impossible;
        return;
      }
      const std::optional<ResolvedPoint> point = resolved(group, row);
      if (!point) return;
      check(known == nullptr, "resolve() accepts what a family of points does not");
      known = &make_family(*point);
    }
    known->family->put_numbers(values_, numbers_);
    const auto is_same = [&](std::uint32_t other) { return is_point(other, *known); };
    if (seen_.add(hash_of(known->outline, numbers_), static_cast<std::uint32_t>(row), is_same))
      points_.rows_.push_back(static_cast<std::uint32_t>(row));
  }

  /// Nothing, if the plan says to leave out what is impossible.
  std::optional<ResolvedPoint> resolved(const SweepGroup& group, std::size_t row) {
    try {
      std::vector<ValueId> own(values_.size(), kUnset);
      points_.groups_.back().put(row - points_.first_rows_.back(), own);
      SweepRow shown;
      for (std::size_t k = 0; k < own.size(); ++k)
        if (own[k] != kUnset) shown[plan_.keys[k].name] = points_.pool_->text(k, own[k]);
      return resolve(plan_, points_.settings_of(values_), inputs_,
                     fmt::format("{}: point {}", group.place.where, text_of(shown)));
    } catch (const InputError& error) {
      if (!plan_.skip_impossible) throw;
      if (expansion_.impossible++ == 0) expansion_.first_impossible = error.what();
      return std::nullopt;
    }
  }

  Known* known_of(std::span<const ValueId> values) {
    std::vector<ValueId> identifier = PointFamily::identifier(plan_, values);
    if (last_ != nullptr && last_->first == identifier) return &last_->second;
    const auto it = known_.find(identifier);
    if (it == known_.end()) return nullptr;
    last_ = &*it;
    return &it->second;
  }

  Known& make_family(const ResolvedPoint& point) {
    std::vector<ValueId> identifier = PointFamily::identifier(plan_, values_);
    auto& family = points_.families_[identifier];
    family = std::make_unique<PointFamily>(plan_, *points_.pool_, values_,
                                           points_.settings_of(values_), point);
    const std::size_t outline =
        outlines_.emplace(family->outline(), outlines_.size()).first->second;
    return known_[std::move(identifier)] = Known{family.get(), outline};
  }

  /// Whether the point of a row is the one whose numbers are in numbers_.
  bool is_point(std::size_t row, const Known& known) {
    points_.put_values(row, other_values_);
    const Known& other = *known_of(other_values_);
    if (other.outline != known.outline) return false;
    other.family->put_numbers(other_values_, other_numbers_);
    return other_numbers_ == numbers_;
  }

  const SweepPlan& plan_;
  SweepInputs& inputs_;
  Expansion expansion_;
  SweepPoints& points_;
  std::map<std::vector<ValueId>, Known> known_;  ///< families by identifier
  std::pair<const std::vector<ValueId>, Known>* last_ = nullptr;
  std::map<std::string, std::size_t> outlines_;
  SeenRows seen_;
  std::vector<ValueId> values_ = std::vector<ValueId>(plan_.keys.size());
  std::vector<ValueId> other_values_ = values_;
  std::vector<double> numbers_ = std::vector<double>(plan_.keys.size());
  std::vector<double> other_numbers_ = numbers_;
};

Expansion expand(const SweepPlan& plan, SweepInputs& inputs) {
  return Expander(plan, inputs).expand();
}

}  // namespace leviosim::tools
