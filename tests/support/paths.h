// Where the tests find the project and its program. One source file knows the paths of this build,
// so that all others compile to the same object in every checkout.
#pragma once

#include <filesystem>
#include <string>

namespace leviosim::tests {

/// The top folder of the project.
std::filesystem::path source_folder();

/// The leviosim program under test; the environment variable LEVIOSIM_TEST_PROGRAM names another
/// one, such as that of an older commit.
std::string program_path();

/// Of this build, which `cmake --install` takes.
std::filesystem::path build_folder();

/// What each room may include, as the build knows it: lines "room: rooms and libraries".
std::filesystem::path rooms_file();

}  // namespace leviosim::tests
