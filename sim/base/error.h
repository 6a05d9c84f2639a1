// What leviosim throws when the *user's input* is at fault: one clear message, exit status 2.
// Faults of leviosim itself are assertions (sim/base/check.h).
#pragma once

#include <stdexcept>
#include <string>

namespace leviosim {

/// Bad input: a file, key, option or request. what() is the one message shown to the user; it names
/// file, line and key where there are such, what was expected, and the nearest valid name.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace leviosim
