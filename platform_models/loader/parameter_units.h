// Units of platform parameters and how they are written: "240 MHz", "128 KiB", "8 B/cycle".
//
// Decimal prefixes are powers of ten and binary ones powers of two: 1 kB = 1000 B, 1 KiB = 1024 B.
// Words such as "cores" or "banks" are units too, so that no number stands alone.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "sim/chip/config.h"

namespace leviosim::platform {

struct Unit {
  std::string_view name;
  double factor;  ///< base units in one of this unit
};

/// A kind of quantity. The base unit, in which ChipConfig stores it, is the first of its units.
/// Choices among names have no units.
struct Dimension {
  std::string_view meaning;  ///< as messages name it
  std::span<const Unit> units;
  bool whole = false;  ///< a number of base units without fraction

  const Unit* find(std::string_view name) const;
  std::string unit_names() const;  ///< "Hz, kHz, MHz, GHz"
};

inline constexpr std::array kFrequencyUnits{Unit{"Hz", 1}, Unit{"kHz", 1e3}, Unit{"MHz", 1e6},
                                            Unit{"GHz", 1e9}};
inline constexpr std::array kSizeUnits{Unit{"B", 1}, Unit{"kB", 1e3}, Unit{"KiB", 1024},
                                       Unit{"MB", 1e6}, Unit{"MiB", 1024.0 * 1024.0}};
inline constexpr std::array kCycleUnits{Unit{"cycles", 1}};
inline constexpr std::array kRateUnits{Unit{"B/cycle", 1}};
inline constexpr std::array kTimeUnits{Unit{"s", 1}, Unit{"ms", 1e-3}, Unit{"us", 1e-6},
                                       Unit{"ns", 1e-9}};
inline constexpr std::array kThroughputUnits{Unit{"B/s", 1}, Unit{"MB/s", 1e6}};
inline constexpr std::array kRatioUnits{Unit{"ratio", 1}};
inline constexpr std::array kCoreUnits{Unit{"cores", 1}};
inline constexpr std::array kBankUnits{Unit{"banks", 1}};
inline constexpr std::array kUnitUnits{Unit{"units", 1}};
inline constexpr std::array kVoltageUnits{Unit{"V", 1}, Unit{"mV", 1e-3}};
inline constexpr std::array kEnergyUnits{Unit{"J", 1}, Unit{"uJ", 1e-6}, Unit{"nJ", 1e-9},
                                         Unit{"pJ", 1e-12}, Unit{"fJ", 1e-15}};
inline constexpr std::array kAreaUnits{Unit{"um2", 1}, Unit{"mm2", 1e6}};
inline constexpr std::array kGateUnits{Unit{"kGE", 1}};
inline constexpr std::array kPowerUnits{Unit{"W", 1}, Unit{"mW", 1e-3}, Unit{"uW", 1e-6},
                                        Unit{"nW", 1e-9}};

inline constexpr Dimension kFrequency{"a frequency", kFrequencyUnits, true};
inline constexpr Dimension kSize{"a size", kSizeUnits, true};
inline constexpr Dimension kCycles{"a number of cycles", kCycleUnits};
inline constexpr Dimension kRate{"a transfer rate", kRateUnits};
inline constexpr Dimension kTime{"a time", kTimeUnits};
inline constexpr Dimension kThroughput{"a transfer rate over time", kThroughputUnits};
inline constexpr Dimension kRatio{"a ratio", kRatioUnits};
inline constexpr Dimension kCores{"a number of cores", kCoreUnits, true};
inline constexpr Dimension kBanks{"a number of banks", kBankUnits, true};
inline constexpr Dimension kUnits{"a number of functional units", kUnitUnits, true};
inline constexpr Dimension kVoltage{"a voltage", kVoltageUnits};
inline constexpr Dimension kEnergy{"an energy", kEnergyUnits};
inline constexpr Dimension kPower{"a power", kPowerUnits};
inline constexpr Dimension kArea{"an area", kAreaUnits};
inline constexpr Dimension kGates{"thousands of gate equivalents", kGateUnits};
inline constexpr Dimension kChoice{"a choice", {}};

std::string_view trim(std::string_view text);

/// A decimal number that fills the whole text; may be infinite or not a number.
std::optional<double> parse_number(std::string_view text);

/// A number and what follows it, "240 MHz" → {240, "MHz"}. Nothing if no number stands in front.
struct Measure {
  double number;
  std::string_view unit;  ///< empty if nothing follows
};
std::optional<Measure> split_measure(std::string_view text);

/// The shortest decimal text that reads back as the same number.
std::string number_text(double number);

}  // namespace leviosim::platform
