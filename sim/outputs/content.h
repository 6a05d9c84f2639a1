// The bytes of a file that is to be written: whole, or piece by piece where they are too many to be
// held.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace leviosim::outputs {

/// Takes the bytes of a file, one piece after the other. @throws InputError if it cannot
using Sink = std::function<void(std::string_view)>;

class Content {
 public:
  Content(std::string_view whole) : whole_(whole) {}  ///< outlives it
  Content(const std::string& whole) : whole_(whole) {}
  Content(const char* whole) : whole_(whole) {}
  /// @param write  hands over all pieces; may be called several times
  Content(std::function<void(const Sink&)> write) : write_(std::move(write)) {}

  void hand_to(const Sink& sink) const {
    if (write_)
      write_(sink);
    else
      sink(whole_);
  }

 private:
  std::string_view whole_;
  std::function<void(const Sink&)> write_;
};

}  // namespace leviosim::outputs
