// The value in a cell of a table: nothing, a number, a number with its band, or words. Values
// stay numbers until they are rendered: table_files.h for programs, terminal_table.h for people.
#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "sim/base/units.h"
#include "tools/app/table/banded.h"

namespace leviosim::tools {

class Cell {
 public:
  using Value = std::variant<std::monostate, std::int64_t, double, Banded, std::string>;

  Cell() = default;  ///< nothing
  Cell(std::string words) : value_(std::move(words)) {}
  Cell(std::string_view words) : value_(std::string(words)) {}
  Cell(const char* words) : value_(std::string(words)) {}
  template <std::integral T>
  Cell(T number) : value_(static_cast<std::int64_t>(number)) {}
  template <class Tag>
  Cell(leviosim::Quantity<Tag, std::int64_t> number) : value_(number.count()) {}
  Cell(double number) : value_(number) {}
  Cell(const Banded& figure) : value_(figure) {}
  template <class T>
  Cell(const std::optional<T>& cell) {
    if (cell) *this = Cell(*cell);
  }

  const Value& value() const { return value_; }

 private:
  Value value_;
};

/// A value of a file, as it is spelled there: a number where it is one.
Cell spelled(std::string_view text);

/// Shown for a cell without a value.
inline constexpr const char* kNothing = "–";

/// With so many decimals; `otherwise` for what does not exist.
std::string figure_text(std::optional<double> value, int decimals,
                        std::string_view otherwise = kNothing);

/// Of an error or a path that is no length any more: farther than any vehicle flies.
inline constexpr const char* kDiverged = "diverged";
inline constexpr double kDiverged_m = 1e6;
/// Metres with so many decimals, without the unit; or kDiverged.
std::string metres_text(std::optional<double> metres, int decimals,
                        std::string_view otherwise = kNothing);
/// "0.366 m"; or kDiverged.
std::string metres(double metres, int decimals);

/// In another unit.
inline std::optional<double> scaled(std::optional<double> value, double factor) {
  return value ? std::optional(*value * factor) : std::nullopt;
}

/// A clock in MHz.
inline double megahertz(Hertz clock) { return static_cast<double>(clock.count()) / 1e6; }

}  // namespace leviosim::tools
