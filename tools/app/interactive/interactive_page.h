// A recorded run as a page that computes (README.md): `leviosim report RUN --interactive`.
#pragma once

#include <string>

#include "sim/base/units.h"

namespace leviosim::tools {

/// @throws InputError if this program was built without the engine, saying how to build it
void expect_engine();

/// The page as one file. @param run  folder of a run with --record
/// @throws InputError if it holds no work trace, and as the readers of its files
std::string interactive_page(const std::string& run, Bytes memory);

}  // namespace leviosim::tools
