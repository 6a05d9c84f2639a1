// Points of a sweep that share trace or data, platform, profile and which keys are set, and differ
// in numbers: parameters of the chip and of the workload, seeds, cores. What they share is worked
// out once, by resolve() of one of them; each further point then costs what it changes, so that a
// million can be checked and listed. Says of every point what resolve() says, without the reasons.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "platform_models/loader/varying_chip.h"
#include "tools/app/study/sweep/resolve.h"
#include "tools/app/study/sweep/value_pool.h"

namespace leviosim::tools {

/// What a key of the plan is at a point, set there or not.
struct PointParameter {
  std::string name;
  std::string text;              ///< "240MHz"
  std::optional<double> number;  ///< toggles are 0 or 1; none for names
  std::string unit;
};

class PointFamily {
 public:
  /// Equal for points of one family.
  /// @param values  one per key of the plan
  static std::vector<ValueId> identifier(const SweepPlan& plan, std::span<const ValueId> values);

  /// @param values,settings,first  one of the points; `plan` and `pool` outlive the family
  PointFamily(const SweepPlan& plan, const ValuePool& pool, std::span<const ValueId> values,
              const SweepRow& settings, const ResolvedPoint& first);

  /// Whether the point can be run. Of a point that was not accepted, nothing below may be asked.
  bool accepts(std::span<const ValueId> values);

  /// Two points of families with the same outline are the same if these are.
  /// @param numbers  one per key of the plan
  void put_numbers(std::span<const ValueId> values, std::span<double> numbers) const;
  /// The identity without what the numbers say. Points of families with another are others.
  const std::string& outline() const { return outline_; }

  /// As text_of() the identity of the point.
  std::string identity(std::span<const ValueId> values) const;
  PointParameter parameter(std::size_t key, std::span<const ValueId> values) const;

 private:
  /// A key of the plan whose value is a number.
  struct Slot {
    std::size_t field = 0;        ///< of the chip's schema
    bool given = false;           ///< there is a value where nothing sets it
    double otherwise = 0;         ///< that one
    SweepNumber unit;             ///< in which numbers of the chip are shown
    std::vector<double> numbers;  ///< by ValueId; kUnread, kImpossible
  };
  /// A piece of the identity: text, and after it the line of a key.
  struct Part {
    std::string text;
    std::optional<SweepKey> key;
    std::size_t index = 0;  ///< of the key in the plan, if it is one of its keys
    std::string rest;       ///< of the line, after the number
  };

  bool is_set(std::size_t key, std::span<const ValueId> values) const {
    return values[key] != kUnset;
  }
  Slot slot_of(std::size_t key) const;
  std::vector<Part> parts_of(const ResolvedPoint& first, std::span<const ValueId> values);
  double read(std::size_t key, ValueId id) const;
  double number(std::size_t key, std::span<const ValueId> values) const;
  int cores(std::span<const ValueId> values) const;
  void change(std::size_t key, std::span<const ValueId> values, double number);
  bool is_possible(std::span<const ValueId> values) const;
  static std::string line(const SweepKey& key, double number);

  const SweepPlan& plan_;
  const ValuePool& pool_;
  const traces::WorkTrace* trace_;
  std::string profile_name_, size_;
  std::uint32_t seed_;
  const platform::Schema& schema_;
  platform::VaryingChip chip_;
  vio::Profile profile_;
  std::optional<int> base_cores_;  ///< that the base sets
  int workers_;                    ///< where no key of the groups sets them
  std::size_t cores_key_, workers_key_;
  std::vector<Slot> slots_;  ///< by key
  std::vector<Part> parts_;
  std::string outline_;
  std::vector<double> last_;  ///< numbers that accepts() saw last
  bool verdict_ = false;
};

}  // namespace leviosim::tools
