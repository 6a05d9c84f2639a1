// The rows of the schema about supply and energy: sections `supply` and `energy`. A platform has
// both in full, or neither: energies of events are not known for every chip.
#pragma once

#include <vector>

#include "platform_models/loader/schema.h"

namespace leviosim::platform {

std::vector<Field> energy_fields();

/// Whether this parameter belongs to the sections that a platform has together or not at all.
bool is_about_energy(const Field& field);

}  // namespace leviosim::platform
