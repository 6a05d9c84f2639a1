// SHA-256, as OpenSSL computes it.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace leviosim::base {

/// A running digest.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void add(std::string_view bytes);
  /// Ends the digest. @returns 64 hexadecimal digits
  std::string hex();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// @returns 64 hexadecimal digits
std::string sha256_of(std::string_view bytes);

}  // namespace leviosim::base
