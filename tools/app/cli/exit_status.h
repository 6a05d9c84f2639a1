// Thrown by a command that is done and has printed its results: the program ends with that status,
// which is 1 where a limit that the user set was not met.
#pragma once

#include <exception>

namespace leviosim::tools {

class EndsWith : public std::exception {
 public:
  explicit EndsWith(int status) : status_(status) {}
  int status() const { return status_; }
  const char* what() const noexcept override { return "a limit was not met"; }

 private:
  int status_;
};

class LimitNotMet : public EndsWith {
 public:
  LimitNotMet() : EndsWith(1) {}
};

}  // namespace leviosim::tools
