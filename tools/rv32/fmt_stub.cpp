// Messages are made in places even where nothing goes wrong; here they are empty.
#include <fmt/core.h>

std::string fmt::vformat(fmt::string_view, fmt::format_args) { return {}; }
