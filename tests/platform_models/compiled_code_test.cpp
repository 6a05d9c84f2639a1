// Tables of compiled code are found by their names.
#include "platform_models/loader/compiled_code.h"

#include <gtest/gtest.h>

#include "sim/base/error.h"

namespace leviosim::platform {
namespace {

TEST(CompiledCode, IsTheTableOfItsName) {
  const work::CodeMap named = code_map_named("rv32imfc");
  EXPECT_GT(named.pieces().size(), 100u);
  ASSERT_EQ(compiled_code().pieces().size(), named.pieces().size());
  for (std::size_t i = 0; i < named.pieces().size(); ++i)
    EXPECT_EQ(compiled_code().pieces()[i].key, named.pieces()[i].key);
}

TEST(CompiledCode, OfAnotherNameIsRefusedWithThoseThatThereAre) {
  try {
    code_map_named("rv32imac");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("'rv32imac'"), std::string::npos) << text;
    EXPECT_NE(text.find("there is rv32imfc"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace leviosim::platform
