// Thrown by a command that is done and has printed its results, where a limit that the user set was
// not met: the program ends with status 1.
#pragma once

#include <exception>

namespace leviosim::tools {

class LimitNotMet : public std::exception {
 public:
  const char* what() const noexcept override { return "a limit was not met"; }
};

}  // namespace leviosim::tools
