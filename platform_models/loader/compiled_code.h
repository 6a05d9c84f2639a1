// What is known of a workload's compiled code: sizes, from which instruction-cache footprints come,
// and executed instructions. code/*.csv is measured by tools/rv32 and part of the program.
#pragma once

#include <string>
#include <string_view>

#include "sim/work/code_map.h"

namespace leviosim::platform {

/// The table that sizes of the workload's code are taken from: as compiled for RV32IMFC.
inline constexpr std::string_view kCompiledCode = "rv32imfc";

/// Rows for kernels of another project, in the format of code_map_from().
struct CodeTable {
  std::string set;  ///< the instruction set that they were compiled for: "rv32imfc"
  std::string text;
};

/// From now on compiled_code() has these rows, too. Functions of kCompiledCode's rows only are found
/// there, so these come with the others. Before anything asks for compiled_code().
/// @throws InputError for another instruction set, broken rows, and functions that are known
void add_compiled_code(const CodeTable& table);

/// The pieces of all named functions of the workload, of the table kCompiledCode, with what they
/// execute as compiled for each of work::kCompiledFor. What was not measured there is that of
/// kCompiledCode.
const work::CodeMap& compiled_code();

/// Bytes of code as compiled for that instruction set for each one of the table kCompiledCode, as
/// tools/rv32/measure.sh measured them: of the pieces that are in both.
double size_of_code(work::CompiledFor set);

/// Of the table code/NAME.csv; what it executes is described at kCompiledCode.
/// @throws InputError with the tables that there are if there is none of this name
work::CodeMap code_map_named(std::string_view name);

/// From the text of such a file: comments (#), a header, then rows of
/// function,after,lines,visits,refetches,executed,priced,loads,used_at_once. `after` is empty for
/// what runs from the function's entry on; lines are the mean number of distinct 16-byte lines that
/// one visit fetches, refetches that of lines which a cache of 512 bytes loses and fetches again
/// meanwhile. Visits are not used here. The last four are those of work::Compiled in a visit of the
/// whole function; empty in other rows, and where it was not measured.
/// @throws InputError with file and line
work::CodeMap code_map_from(const std::string& file, std::string_view text);

}  // namespace leviosim::platform
