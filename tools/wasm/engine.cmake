# The engine of interactive pages as page_engine, a file in gzip that becomes part of the program
# (tools/wasm/README.md). Its packages are named by tools/setup.sh.
find_program(WASM_CLANG NAMES clang++-14 clang++ REQUIRED)
find_program(WASM_LINKER NAMES wasm-ld-14 wasm-ld REQUIRED)
find_program(GZIP gzip REQUIRED)
if(NOT EXISTS /usr/lib/llvm-14/include/wasm32-wasi/c++/v1 OR NOT EXISTS /usr/include/wasm32-wasi)
  message(FATAL_ERROR "LEVIOSIM_WASM needs the packages clang, lld, wasi-libc, libc++-14-dev-wasm32 and "
                      "libclang-rt-14-dev-wasm32; tools/setup.sh pages installs them")
endif()
file(GLOB_RECURSE engine_sources CONFIGURE_DEPENDS
  ${CMAKE_SOURCE_DIR}/sim/*.h ${CMAKE_SOURCE_DIR}/sim/*.cpp ${CMAKE_SOURCE_DIR}/platform_models/loader/*
  ${CMAKE_SOURCE_DIR}/traces/work_traces/* ${CMAKE_SOURCE_DIR}/workload/vio/*.h
  ${CMAKE_SOURCE_DIR}/tools/app/run/* ${CMAKE_SOURCE_DIR}/tools/app/result/* ${CMAKE_SOURCE_DIR}/tools/app/record/*
  ${CMAKE_SOURCE_DIR}/tools/app/table/json.* ${CMAKE_SOURCE_DIR}/tools/wasm/*)
set(page_engine ${CMAKE_CURRENT_BINARY_DIR}/engine.gz)
add_custom_command(
  OUTPUT ${page_engine}
  COMMAND ${CMAKE_COMMAND} -E env CLANG=${WASM_CLANG} LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER}
          ${CMAKE_SOURCE_DIR}/tools/wasm/build.sh ${CMAKE_CURRENT_BINARY_DIR}/engine.wasm
  COMMAND ${GZIP} --best --no-name --stdout ${CMAKE_CURRENT_BINARY_DIR}/engine.wasm > ${page_engine}
  DEPENDS ${engine_sources}
  COMMENT "Compiling the engine of interactive pages"
  VERBATIM)
