// What a claim of an output refuses, for tests of files and of folders.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/outputs/output_place.h"

namespace leviosim::outputs {

/// Claiming an `Output` (OutputFile, OutputFolder) throws an InputError that contains all parts.
template <class Output>
void expect_claim_refused(const OutputRequest& wanted, const std::vector<std::string>& parts) {
  try {
    const Output out(wanted);
    ADD_FAILURE() << wanted.path << " was not refused";
  } catch (const InputError& error) {
    for (const std::string& part : parts)
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

}  // namespace leviosim::outputs
