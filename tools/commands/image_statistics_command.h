// `leviosim image-statistics`: what the pictures of recordings are like, side by side.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_image_statistics_command(CLI::App& app);

}  // namespace leviosim::tools
