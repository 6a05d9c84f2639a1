// Frames of films: the content of sections, whose checksums are right.
#include "tools/app/film/film.h"
#include "tests/fuzz/fuzz_target.h"
#include "traces/work_traces/section_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leviosim;
  std::string bytes = traces::file_head({"LEVIOFM\n", "a film", 1});
  for (const std::string& frame : fuzz::parts_of(fuzz::text_of(data, size)))
    bytes += traces::packed_section(frame, 1);
  return fuzz::only_input_errors([&] { tools::film_of("film", bytes, Bytes(1 << 22)); });
}
