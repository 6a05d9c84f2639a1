// Shared by the tests of platform files.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "platform_models/loader/builtin.h"
#include "platform_models/loader/loader.h"
#include "platform_models/loader/schema.h"
#include "sim/base/error.h"

namespace leviosim::platform {

inline std::string gap9_text() {
  for (const base::BuiltinFile& platform : builtin_platforms())
    if (platform.name == "gap9") return std::string(platform.text);
  ADD_FAILURE() << "gap9 is not built in";
  return {};
}

/// The text with its first occurrence of `from` replaced.
inline std::string replaced(std::string text, std::string_view from, std::string_view to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "no '" << from << "' in the text";
  if (at != std::string::npos) text.replace(at, from.size(), to);
  return text;
}

/// Number of the first line that contains `part`, from 1.
inline int line_of(const std::string& text, std::string_view part) {
  const std::size_t at = text.find(part);
  EXPECT_NE(at, std::string::npos) << "no '" << part << "' in the text";
  int line = 1;
  for (std::size_t i = 0; i < at && i < text.size(); ++i) line += text[i] == '\n';
  return line;
}

/// The message of the InputError that `action` must throw.
template <class Action>
std::string fault_of(Action action) {
  try {
    action();
  } catch (const InputError& e) {
    return e.what();
  }
  ADD_FAILURE() << "no InputError was thrown";
  return {};
}

inline void expect_parts(const std::string& message, const std::vector<std::string_view>& parts) {
  for (const std::string_view part : parts)
    EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' is not in: " << message;
}

/// Every number of the configuration, in the order of the schema.
inline std::vector<double> numbers_of(const sim::ChipConfig& chip) {
  std::vector<double> numbers;
  const Schema schema;
  for (const Field& field : schema.fields()) numbers.push_back(field.get(chip));
  return numbers;
}

}  // namespace leviosim::platform
