// The constants that a calibration may fit: what a compiler adds to the operations of a source
// program, for all code of the instruction set alike. None belongs to a kernel or a stage, and
// nothing that a data sheet, RTL or a measurement gives is among them.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "platform_models/loader/variants.h"

namespace leviosim::tools {

struct FittableConstant {
  std::string_view path;
  std::string_view mechanism;
};

inline constexpr std::array kFittableConstants{
    FittableConstant{"isa.instruction_overhead", "the vendor's compiler"},
    FittableConstant{"isa.load_use_fraction", "loads in code that was not measured"},
    FittableConstant{"isa.ops.loop_iteration.issue",
                     "counter and branch of loops that are no hardware loops"},
    FittableConstant{"isa.ops.loop_entry.issue", "pointers and counter set up before a loop"},
    FittableConstant{"isa.ops.call.issue", "registers saved and restored around a call"},
    FittableConstant{"isa.ops.load_indexed.issue", "address arithmetic of a load"},
    FittableConstant{"isa.ops.store_indexed.issue", "address arithmetic of a store"},
};

inline constexpr std::size_t kMostConstants = 3;
inline constexpr const char* kDefaultConstants =
    "isa.instruction_overhead,isa.load_use_fraction,isa.ops.loop_iteration.issue";

/// "a,b,c" → paths.
/// @throws InputError for none, more than three, one twice, and what must not be fitted
std::vector<std::string> parse_constants(const std::string& option, const std::string& text);

/// A constant as a number between bounds, in its unit.
struct Bounded {
  std::string path;
  std::string unit;
  double value = 0;
  double low = 0;
  double high = 0;
};

/// @throws InputError if the platform gives no range to fit within
std::vector<Bounded> bounds_of(const platform::Variants& platform,
                               const std::vector<std::string>& paths);

}  // namespace leviosim::tools
